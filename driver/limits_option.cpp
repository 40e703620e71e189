#include "driver/limits_option.h"

#include <CLI/CLI.hpp>

namespace gradus {

void add_limits_option(CLI::App &command, std::uint64_t &limits, const char *group) {
    command
        .add_option("--limits", limits, "Files may be so many times as large as is thought sane (docs/scene-format.md)")
        ->type_name("FACTOR")
        ->check(CLI::Range(1, 1000000))
        ->group(group);
}

} // namespace gradus
