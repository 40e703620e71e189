#include "driver/output_files.h"

#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/io/image_io.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <exception>
#include <filesystem>

namespace gradus {

void check_outputs(const OutputFiles &files) {
    if (std::filesystem::path(files.image).filename() == ".exr")
        throw Error(ExitCode::usage, fmt::format("the output '{}' has no name before its ending", files.image));
    if (std::filesystem::path(files.image).extension() != ".exr")
        throw Error(ExitCode::usage,
                    fmt::format("the output '{}' must end in .exr; --png writes a PNG beside it", files.image));
    check_writable(files.image);
    if (files.png)
        check_writable(png_path(files.image));
    if (!files.statistics.empty() && files.statistics != "-")
        check_writable(files.statistics);
    check_distinct(output_list(files), {});
}

std::vector<NamedFile> output_list(const OutputFiles &files) {
    std::vector<NamedFile> list{{"--output", files.image}, {"--stats", files.statistics}};
    if (files.png)
        list.push_back({"--png", png_path(files.image)});
    return list;
}

namespace {

/// The name of a file with neither links nor ".." in it; the file need not be there.
std::filesystem::path plain_path(const std::string &path) {
    std::error_code failure;
    const std::filesystem::path plain = std::filesystem::weakly_canonical(path, failure);
    return failure ? std::filesystem::absolute(path, failure).lexically_normal() : plain;
}

bool is_same_file(const std::string &first, const std::string &second) {
    std::error_code not_there;
    return plain_path(first) == plain_path(second) || std::filesystem::equivalent(first, second, not_there);
}

} // namespace

void check_folder(const std::string &path) {
    std::error_code failure;
    std::filesystem::create_directories(path, failure);
    if (failure)
        throw Error(ExitCode::output, fmt::format("cannot make the folder '{}': {}", path, failure.message()));
    check_writable((std::filesystem::path(path) / ".gradus").string());
}

void check_distinct(const std::vector<NamedFile> &outputs, const std::vector<std::string> &inputs) {
    std::vector<NamedFile> written;
    for (const NamedFile &output : outputs) {
        if (output.path.empty() || output.path == "-")
            continue;
        const std::string file = written_file(output.path);
        for (const NamedFile &other : written)
            if (is_same_file(file, other.path))
                throw Error(ExitCode::usage,
                            fmt::format("{} and {} name the same file '{}'", output.use, other.use, output.path));
        for (const std::string &input : inputs)
            if (!input.empty() && is_same_file(file, input))
                throw Error(ExitCode::usage, fmt::format("{} '{}' is a file to read ('{}'), and would be replaced",
                                                         output.use, output.path, input));
        written.push_back({output.use, file});
    }
}

std::string png_path(const std::string &image) {
    return std::filesystem::path(image).replace_extension(".png").string();
}

void write_outputs(const OutputFiles &files, const Image &image, const Image &picture,
                   const std::function<nlohmann::json()> &statistics) {
    std::exception_ptr failure;
    const auto attempt = [&](const auto &write) {
        try {
            write();
        } catch (const std::exception &error) {
            if (failure)
                print_message(fmt::format("gradus: error: {}\n", error.what()));
            else
                failure = std::current_exception();
        }
    };
    attempt([&] { write_image(image, files.image); });
    if (files.png)
        attempt([&] { write_png(picture, png_path(files.image)); });
    if (!files.statistics.empty())
        attempt([&] { write_json(statistics(), files.statistics); });
    if (failure)
        std::rethrow_exception(failure);
}

std::string json_text(const nlohmann::json &json) {
    // A path in the file system need not be UTF-8.
    return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void write_json(const nlohmann::json &json, const std::string &path) {
    const std::string text = json_text(json);
    if (path == "-")
        print_result(text);
    else
        write_file_atomically(path, text.data(), text.size());
}

} // namespace gradus
