// Tells on the progress line which phase is under way before a render, where that lasts.
#pragma once

#include "driver/progress.h"
#include "runtime/phases.h"

#include <condition_variable>
#include <mutex>
#include <thread>

namespace gradus {

/// Looks at the phases for as long as it lives.
class PhaseWatch {
  public:
    PhaseWatch(const Phases &phases, Progress &progress);
    ~PhaseWatch();
    PhaseWatch(const PhaseWatch &) = delete;
    PhaseWatch &operator=(const PhaseWatch &) = delete;

  private:
    void look();

    const Phases &phases_;
    Progress &progress_;
    std::mutex mutex_;
    std::condition_variable ended_;
    bool is_ended_ = false;
    std::thread thread_;
};

} // namespace gradus
