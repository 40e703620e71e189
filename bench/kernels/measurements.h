// The measurements of gradus-bench-kernels, one file each. Each prints its table and returns the same as JSON.
#pragma once

#include "runtime/device/device.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::bench {

/// What all measurements share.
struct Settings {
    Device &device;
    int threads;       ///< of the processor; 0: all
    std::string scene; ///< a file; see throughput.cpp
    int repeats = 5;
    std::vector<std::uint32_t> queue_sizes; ///< squares of powers of two
    std::vector<std::string> kinds;         ///< of BSDFs
    std::vector<std::string> methods;       ///< that are rendered with
    std::uint32_t cases = 0;                ///< of each function and domain, for the accuracy
    bool is_quick = false;
    bool asks_vectoriser = true; ///< whether PoCL vectorised a kernel
};

/// The kernels of renders and of a solve in their builds, over queue sizes.
nlohmann::json measure_throughput(const Settings &settings);

/// Has PoCL's compiler make its remarks on each of these kernels; see vector_width.h.
void remark_on_kernels(const Settings &settings);

/// Errors of the float and relaxed builds of kernels/lib against the double build, on the device.
nlohmann::json measure_accuracy(const Settings &settings);

/// The sort of runtime/wavefront, sums over runs of equal keys, and splats.
nlohmann::json measure_sort(const Settings &settings);

/// Gathering of photons over a triad of its bytes, and manifold walks, in the methods that have them, by stages' times.
nlohmann::json measure_photons(const Settings &settings);

/// What the work-group and batch size that a tuner chose gain.
nlohmann::json measure_tuning(const Settings &settings);

} // namespace gradus::bench
