// Which device computes, and on how many threads.
#pragma once

#include "driver/number_checks.h"

#include <CLI/CLI.hpp>

#include <string>

namespace gradus {

/// --device and --nthreads.
inline void add_device_options(CLI::App &command, const std::string &group, std::string &device, int &threads) {
    command.add_option("--device", device, "OpenCL device: a number of `gradus devices` or a part of its name")
        ->group(group);
    command.add_option("--nthreads", threads, "Processor threads; 0: all")
        ->transform(whole_number_between(0, 4096))
        ->capture_default_str()
        ->group(group);
}

} // namespace gradus
