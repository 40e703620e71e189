// The statistics of a render as JSON.
#pragma once

#include "driver/services.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// What Statistics does not know of a render.
struct RenderRecord {
    std::string scene, method, precision, sampler;
    DeviceDescription device;
    std::uint64_t seed = 0;
    std::uint32_t width = 0, height = 0;
    double samples_per_pixel = 0; ///< done, on average
    bool interrupted = false;
    std::string stopped_by = "samples"; ///< or "time", "error", "interrupt"
    double prepare_seconds = 0;         ///< kernels, tables and the ray tracer's tree
    /// Of what came before the first sample, by the keys of runtime/phases.h.
    std::vector<std::pair<std::string, double>> phase_seconds;
    double wall_seconds = 0; ///< the whole command until the image was written
};

/// Keys are sorted but for the list of stages, which is in the order of the method. Every rate is over the seconds
/// spent rendering. Described in docs/command-line.md.
nlohmann::json statistics_to_json(const RenderRecord &record, const Statistics &statistics);

/// What the method `auto` picked, and why.
nlohmann::json choice_json(const MethodChoice &choice);

/// Which device did the work: name, platform, version, driver and type.
nlohmann::json device_json(const DeviceDescription &device);

/// The most memory that this process had in use so far, in bytes.
std::uint64_t peak_memory_bytes();

} // namespace gradus
