#include "driver/phase_watch.h"

#include <chrono>
#include <optional>
#include <system_error>

namespace gradus {

namespace {
constexpr double felt = 0.5; ///< seconds after which a wait asks for a reason
constexpr std::chrono::milliseconds interval(100);
} // namespace

PhaseWatch::PhaseWatch(const Phases &phases, Progress &progress) : phases_(phases), progress_(progress) {
    if (progress_.mode() == Progress::Mode::quiet)
        return;
    try {
        thread_ = std::thread([this] { look(); });
    } catch (const std::system_error &) { // no room for a thread: nothing is told
    }
}

PhaseWatch::~PhaseWatch() {
    if (!thread_.joinable())
        return;
    {
        const std::lock_guard lock(mutex_);
        is_ended_ = true;
    }
    ended_.notify_one();
    thread_.join();
    progress_.phase_ended();
}

void PhaseWatch::look() {
    std::unique_lock lock(mutex_);
    while (!ended_.wait_for(lock, interval, [this] { return is_ended_; })) {
        const std::optional<Phases::Time> now = phases_.current();
        if (now && now->seconds >= felt)
            progress_.phase(now->name.text, now->seconds);
        else
            progress_.phase_ended();
    }
}

} // namespace gradus
