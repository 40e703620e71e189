// What a solve did, as text and as JSON.
#pragma once

#include "driver/services.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <map>
#include <string>

namespace gradus {

/// What PoissonReport does not know of a solve.
struct SolveRecord {
    std::string reconstruction; ///< "l1", "l2", "weighted"
    std::string norm, weights;  ///< "L1" or "L2"; "uniform" or "variance"
    std::uint32_t width = 0, height = 0, channels = 0;
    DeviceDescription device;
    double prepare_seconds = 0; ///< device, buffers and kernels
    double wall_seconds = 0;    ///< the whole command until the image was written
};

/// Lines for the user, each with its name in front.
std::string solve_report_text(const PoissonReport &report);

/// Everything of the report and the record. What is not finite becomes null. Described in docs/command-line.md.
nlohmann::json solve_report_json(const SolveRecord &record, const PoissonReport &report);

} // namespace gradus
