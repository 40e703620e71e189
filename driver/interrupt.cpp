#include "driver/interrupt.h"

#include <csignal>
#include <cstddef>

namespace gradus {
namespace {

constexpr int watched[] = {SIGINT, SIGTERM, SIGHUP};
constexpr std::size_t watched_count = sizeof watched / sizeof watched[0];

volatile std::sig_atomic_t interrupted = 0;
struct sigaction before[watched_count];

// Gives the default action back to every signal but those that were ignored, so that the next one ends the process.
void on_signal(int) {
    interrupted = 1;
    struct sigaction standard = {};
    standard.sa_handler = SIG_DFL;
    for (std::size_t i = 0; i < watched_count; ++i)
        if (before[i].sa_handler != SIG_IGN)
            sigaction(watched[i], &standard, nullptr);
}

} // namespace

InterruptWatch::InterruptWatch() {
    interrupted = 0;
    struct sigaction action = {};
    action.sa_handler = on_signal;
    // Calls of the file system, of Embree and of OpenCL shall not see EINTR.
    action.sa_flags = SA_RESTART;
    for (std::size_t i = 0; i < watched_count; ++i)
        sigaction(watched[i], nullptr, &before[i]);
    for (std::size_t i = 0; i < watched_count; ++i)
        if (before[i].sa_handler != SIG_IGN)
            sigaction(watched[i], &action, nullptr);
}

InterruptWatch::~InterruptWatch() {
    for (std::size_t i = 0; i < watched_count; ++i)
        sigaction(watched[i], &before[i], nullptr);
}

bool InterruptWatch::requested() const { return interrupted != 0; }

} // namespace gradus
