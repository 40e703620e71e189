// Finds the work-group and the batch size that render fastest on a device, by short trials. The image does not depend
// on either: a candidate that changes a bit of it is thrown out.
#pragma once

#include "methods/method.h"
#include "runtime/device/device.h"

#include <functional>
#include <string>
#include <vector>

namespace gradus {

/// 0: the default.
struct Tuning {
    std::uint32_t work_group_size = 0, batch_size = 0;
    bool operator==(const Tuning &) const = default;
};

/// "work-groups 128, batches default".
inline std::string name_of(const Tuning &tuning) {
    const auto number = [](std::uint32_t value) { return value ? std::to_string(value) : std::string("default"); };
    return "work-groups " + number(tuning.work_group_size) + ", batches " + number(tuning.batch_size);
}

struct TuningTrial {
    Tuning tuning;
    bool same_image = false;   ///< bit for bit that of the defaults
    std::string failure;       ///< why it could not be tried, as where a work-group is too large for the device
    std::vector<double> gains; ///< samples per second over those of the defaults, one for each turn
    double median_gain = 0;
};

struct TuningReport {
    Tuning chosen; ///< all 0 where nothing gains
    std::vector<TuningTrial> trials;
};

struct TuningOptions {
    int threads = 0; ///< that trace, as RenderOptions has them; the device has its own
    int turns = 5;
    double seconds_a_turn = 0.15; ///< of each candidate
    /// Called after each candidate has been judged.
    std::function<void(const TuningTrial &)> on_trial;
};

/// Tries batch sizes with the default work-group, then work-groups with the best of these. Candidates and defaults take
/// turns. A candidate is taken if it gains at least 3 % in the median, and something in three of four turns: less is
/// what turns of the same render differ by. `scene`'s sample count is ignored.
TuningReport tune(Device &device, const std::string &method, const Scene &scene, const TuningOptions &options = {});

/// The gain of one choice over the defaults, measured anew.
TuningTrial try_tuning(Device &device, const std::string &method, const Scene &scene, const Tuning &tuning,
                       const TuningOptions &options = {});

} // namespace gradus
