// Where programs keep what they can make again.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace gradus {

/// $XDG_CACHE_HOME where that is an absolute path, else ~/.cache. Empty where there is no home.
inline std::filesystem::path user_cache_folder() {
    const char *cache = std::getenv("XDG_CACHE_HOME"), *home = std::getenv("HOME");
    if (cache && std::filesystem::path(cache).is_absolute()) // others are not to be used
        return cache;
    return home && *home ? std::filesystem::path(home) / ".cache" : std::filesystem::path();
}

} // namespace gradus
