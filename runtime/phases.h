// What happens before a render's first sample and after its last: which phase is under way, and how long each took.
#pragma once

#include "runtime/seconds_since.h"

#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <vector>

namespace gradus {

struct PhaseName {
    const char *key;  ///< in statistics
    const char *text; ///< for a line that says what is being done
};

namespace phase_names {
constexpr PhaseName parse{"parse", "parsing the scene's files"};
constexpr PhaseName build{"build", "building the scene"};
constexpr PhaseName pictures{"pictures", "decoding pictures"};
constexpr PhaseName meshes{"meshes", "building meshes"};
constexpr PhaseName device{"device", "opening the device"};
constexpr PhaseName tables{"tables", "laying out tables and lights"};
constexpr PhaseName tree{"tree", "building the ray tracing tree"};
constexpr PhaseName compile{"compile", "compiling kernels"};
constexpr PhaseName image{"image", "making the image"};
} // namespace phase_names

/// Phases begin and end on one thread and may lie in each other: time counts for the innermost. Others may look on.
class Phases {
  public:
    struct Time {
        PhaseName name;
        double seconds;
    };

    void begin(const PhaseName &name) {
        const std::lock_guard lock(mutex_);
        settle();
        std::size_t place = 0;
        while (place < times_.size() && times_[place].name.key != name.key)
            ++place;
        if (place == times_.size())
            times_.push_back({name, 0});
        open_.push_back(place);
    }
    void end() {
        const std::lock_guard lock(mutex_);
        settle();
        open_.pop_back();
    }
    /// In the order in which they began first.
    std::vector<Time> times() const {
        const std::lock_guard lock(mutex_);
        return times_;
    }
    /// The one under way, with all the time that it took so far.
    std::optional<Time> current() const {
        const std::lock_guard lock(mutex_);
        if (open_.empty())
            return std::nullopt;
        const Time &time = times_[open_.back()];
        return Time{time.name, time.seconds + seconds_since(since_)};
    }

  private:
    void settle() {
        if (!open_.empty())
            times_[open_.back()].seconds += seconds_since(since_);
        since_ = std::chrono::steady_clock::now();
    }

    mutable std::mutex mutex_;
    std::vector<Time> times_;
    std::vector<std::size_t> open_; ///< places in times_, outermost first
    std::chrono::steady_clock::time_point since_;
};

/// A phase for as long as this lives; of no phases nothing.
class Phase {
  public:
    Phase(Phases *phases, const PhaseName &name) : phases_(phases) {
        if (phases_)
            phases_->begin(name);
    }
    ~Phase() {
        if (phases_)
            phases_->end();
    }
    Phase(const Phase &) = delete;
    Phase &operator=(const Phase &) = delete;

  private:
    Phases *phases_;
};

/// What `work` returns, in a phase.
template <typename Work>
auto in_phase(Phases *phases, const PhaseName &name, const Work &work) {
    const Phase phase(phases, name);
    return work();
}

} // namespace gradus
