#include "driver/limits_option.h"

#include "driver/number_checks.h"

#include <CLI/CLI.hpp>

namespace gradus {

void add_limits_option(CLI::App &command, std::uint64_t &limits, const char *group) {
    command
        .add_option("--limits", limits, "Files may be so many times as large as is thought sane (docs/scene-format.md)")
        ->type_name("FACTOR")
        ->transform(whole_number_between(1, 1000000))
        ->group(group);
}

} // namespace gradus
