#include "runtime/device/pocl_linker.h"

#include "runtime/device/opencl.h"

#include <cstdlib>
#include <fstream>
#include <system_error>

namespace gradus {

namespace fs = std::filesystem;

namespace {

/// A symbol that no library defines is an error in the first link, and not what a launch finds. Signals are for others
/// (run_compile_worker()); shells unblock them.
constexpr const char *script = R"(#!/bin/sh
trap '' INT TERM HUP
without_libraries() {
    for argument do
        shift
        case $argument in -lm | -lc | -lgcc_s) ;; *) set -- "$@" "$argument" ;; esac
    done
    ld "$@" -z defs
}
without_libraries "$@" 2>/dev/null || exec ld "$@"
)";

} // namespace

void prepare_pocl_linker(const fs::path &folder, const DeviceDescription &description) {
    constexpr const char *variable = "COMPILER_PATH";
    if (folder.empty() || !is_pocl_3_1_cpu(description) || std::getenv(variable))
        return;
    std::error_code failure;
    const fs::path linkers = folder / "linkers", linker = linkers / "ld";
    fs::create_directories(linkers, failure);
    if (!(std::ofstream(linker) << script).flush())
        return;
    fs::permissions(linker, fs::perms::owner_all, failure);
    if (!failure)
        setenv(variable, linkers.c_str(), 1);
}

} // namespace gradus
