#include "driver/output_files.h"

#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/io/atomic_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace gradus {

void check_outputs(const OutputFiles &files) {
    if (std::filesystem::path(files.image).extension() != ".exr")
        throw Error(ExitCode::usage,
                    fmt::format("the output '{}' must end in .exr; --png writes a PNG beside it", files.image));
    check_writable(files.image);
    if (files.png)
        check_writable(png_path(files.image));
    if (!files.statistics.empty() && files.statistics != "-") {
        if (files.statistics == files.image)
            throw Error(ExitCode::usage, "--stats and --output name the same file");
        check_writable(files.statistics);
    }
}

std::string png_path(const std::string &image) {
    return std::filesystem::path(image).replace_extension(".png").string();
}

void write_json(const nlohmann::json &json, const std::string &path) {
    // A path in the file system need not be UTF-8.
    const std::string text = json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    if (path == "-")
        print_result(text);
    else
        write_file_atomically(path, text.data(), text.size());
}

} // namespace gradus
