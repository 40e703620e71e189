#include "driver/tuning_store.h"

#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/user_cache_folder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>

namespace gradus {
namespace {

constexpr int format_version = 1;
constexpr std::uint32_t largest_work_group = 1024, least_batch = 64, largest_batch = 1u << 28;

/// A tuning is for a device with one driver: another one compiles otherwise.
bool is_of(const nlohmann::json &entry, const DeviceDescription &device) {
    return entry.at("platform") == device.platform && entry.at("name") == device.name &&
           entry.at("driver") == device.driver && entry.at("compute_units") == device.compute_units;
}

/// Throws nlohmann::json::exception or Error for an entry that this program has not written.
Tuning tuning_of(const nlohmann::json &entry) {
    const auto number = [&](const char *key) {
        if (!entry.at(key).is_number_unsigned())
            throw Error(ExitCode::failure, fmt::format("{} is {}", key, entry.at(key).dump()));
        return entry.at(key).get<std::uint64_t>();
    };
    const std::uint64_t work_group = number("work_group_size"), batch = number("batch_size");
    const bool is_power = work_group >= 8 && work_group <= largest_work_group && (work_group & (work_group - 1)) == 0;
    if ((work_group != 0 && !is_power) || (batch != 0 && (batch < least_batch || batch > largest_batch)))
        throw Error(ExitCode::failure, fmt::format("work-groups of {}, batches of {}", work_group, batch));
    return {static_cast<std::uint32_t>(work_group), static_cast<std::uint32_t>(batch)};
}

/// The entries of the file; empty where there is no file. Throws Error where it is damaged.
nlohmann::json read_entries(const std::string &path) {
    std::error_code ignored;
    if (path.empty() || !std::filesystem::exists(path, ignored))
        return nlohmann::json::array();
    std::ifstream file(path);
    if (!file)
        throw Error(ExitCode::failure, "it cannot be read");
    try {
        const nlohmann::json json = nlohmann::json::parse(file);
        if (json.at("version") != format_version)
            throw Error(ExitCode::failure, "it is of another version");
        const nlohmann::json &entries = json.at("devices");
        for (const nlohmann::json &entry : entries) {
            is_of(entry, {});
            tuning_of(entry);
        }
        if (!entries.is_array())
            throw Error(ExitCode::failure, "it is not a list of devices");
        return entries;
    } catch (const nlohmann::json::exception &error) {
        throw Error(ExitCode::failure, fmt::format("it is not what `gradus tune` writes ({})", error.what()));
    }
}

} // namespace

std::string tuning_file() {
    const std::filesystem::path cache = user_cache_folder();
    return cache.empty() ? "" : (cache / "gradus" / "tuning.json").string();
}

std::optional<Tuning> stored_tuning(const DeviceDescription &device, std::string *problem) {
    const std::string path = tuning_file();
    try {
        for (const nlohmann::json &entry : read_entries(path))
            if (is_of(entry, device))
                return tuning_of(entry);
    } catch (const Error &error) {
        if (problem)
            *problem = fmt::format("{} is not used: {}", path, error.what());
    }
    return std::nullopt;
}

void check_tuning_file() {
    const std::string path = tuning_file();
    if (path.empty())
        throw Error(ExitCode::output, "there is no cache folder to keep the tuning in: set XDG_CACHE_HOME or HOME");
    std::error_code failure;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path(), failure);
    if (failure)
        throw Error(ExitCode::output, fmt::format("cannot make the folder of {}: {}", path, failure.message()));
    check_writable(path);
}

void store_tuning(const DeviceDescription &device, const Tuning &tuning) {
    check_tuning_file();
    const std::string path = tuning_file();
    nlohmann::json kept = nlohmann::json::array();
    try {
        for (const nlohmann::json &entry : read_entries(path))
            if (!is_of(entry, device))
                kept.push_back(entry);
    } catch (const Error &) {
        kept = nlohmann::json::array();
    }
    kept.push_back({{"platform", device.platform},
                    {"name", device.name},
                    {"driver", device.driver},
                    {"compute_units", device.compute_units},
                    {"work_group_size", tuning.work_group_size},
                    {"batch_size", tuning.batch_size}});
    const std::string text = nlohmann::json{{"version", format_version}, {"devices", kept}}.dump(
                                 2, ' ', false, nlohmann::json::error_handler_t::replace) +
                             "\n";
    write_file_atomically(path, text.data(), text.size());
}

void apply_tuning(const std::optional<Tuning> &tuning, RenderOptions &options) {
    if (!tuning)
        return;
    if (options.work_group_size == 0)
        options.work_group_size = tuning->work_group_size;
    if (options.batch_size == 0)
        options.batch_size = tuning->batch_size;
}

} // namespace gradus
