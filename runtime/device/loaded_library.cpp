#include "runtime/device/loaded_library.h"

#include <link.h>

#include <cstddef>
#include <string>

namespace gradus {

void *loaded_library(std::string_view name) {
    struct Search {
        std::string_view name;
        std::string path;
    } search{name, {}};
    dl_iterate_phdr(
        [](dl_phdr_info *info, std::size_t, void *data) {
            Search &wanted = *static_cast<Search *>(data);
            const std::string_view path = info->dlpi_name;
            const bool is_wanted = path.substr(path.rfind('/') + 1).starts_with(wanted.name);
            if (is_wanted)
                wanted.path = path;
            return int(is_wanted);
        },
        &search);
    return search.path.empty() ? nullptr : dlopen(search.path.c_str(), RTLD_NOLOAD | RTLD_LAZY);
}

} // namespace gradus
