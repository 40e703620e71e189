// What kernels took, by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

class Kernel;

struct KernelTime {
    std::string name;
    double seconds = 0;
    std::uint64_t launches = 0;
};

/// Adds to the times of kernels of the same name, or in the order of names.
void add_time(std::vector<KernelTime> &times, const KernelTime &time);
/// Adds what kernels took since their usage was reset; no matter to those that were not launched.
void add_times(std::vector<KernelTime> &times, const std::vector<Kernel *> &kernels);
void reset_times(const std::vector<Kernel *> &kernels);

} // namespace gradus
