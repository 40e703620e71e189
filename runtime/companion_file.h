// Files that programs of this project need beside themselves.
#pragma once

#include <filesystem>
#include <system_error>

namespace gradus {

/// Where the file lies: in the folder of the running program, else in ../libexec/gradus seen from there (installations
/// may have been moved), else where it was built, else where it was to be installed. Empty where it is in none of them.
inline std::filesystem::path companion_file(const std::filesystem::path &of_build,
                                            const std::filesystem::path &of_installation) {
    namespace fs = std::filesystem;
    std::error_code failure;
    const fs::path folder = fs::read_symlink("/proc/self/exe", failure).parent_path(), name = of_build.filename();
    for (const fs::path &place : {folder / name, folder / "../libexec/gradus" / name, of_build, of_installation})
        if (fs::is_regular_file(place, failure))
            return place;
    return {};
}

} // namespace gradus
