#include "driver/interrupt.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>

namespace gradus {
namespace {

constexpr int watched[] = {SIGINT, SIGTERM, SIGHUP};
constexpr std::size_t watched_count = sizeof watched / sizeof watched[0];

/// As the process was started with it. Libraries that compile put handlers of their own in the place of SIG_IGN.
const std::array<bool, watched_count> was_ignored = [] {
    std::array<bool, watched_count> at_start{};
    for (std::size_t signal = 0; signal < watched_count; ++signal) {
        struct sigaction action = {};
        sigaction(watched[signal], nullptr, &action);
        at_start[signal] = action.sa_handler == SIG_IGN;
    }
    return at_start;
}();

volatile std::sig_atomic_t interrupted = 0;
const char *volatile answer_line = nullptr;
struct sigaction before[watched_count];

// Gives the default action back to every signal but those that were ignored, so that the next one ends the process.
void on_signal(int) {
    const int error = errno; // of the code that it came between
    interrupted = 1;
    const char *const line = answer_line;
    if (line && write(STDERR_FILENO, line, std::strlen(line)) < 0)
        answer_line = nullptr; // nobody reads it
    struct sigaction standard = {};
    standard.sa_handler = SIG_DFL;
    for (std::size_t i = 0; i < watched_count; ++i)
        if (!was_ignored[i])
            sigaction(watched[i], &standard, nullptr);
    errno = error;
}

} // namespace

void ignore_what_was_ignored() {
    struct sigaction ignore = {};
    ignore.sa_handler = SIG_IGN;
    for (std::size_t i = 0; i < watched_count; ++i)
        if (was_ignored[i])
            sigaction(watched[i], &ignore, nullptr);
}

InterruptWatch::InterruptWatch() {
    interrupted = 0;
    answer_line = nullptr;
    struct sigaction action = {};
    action.sa_handler = on_signal;
    // Calls of the file system, of Embree and of OpenCL shall not see EINTR.
    action.sa_flags = SA_RESTART;
    ignore_what_was_ignored();
    for (std::size_t i = 0; i < watched_count; ++i)
        sigaction(watched[i], nullptr, &before[i]);
    for (std::size_t i = 0; i < watched_count; ++i)
        if (!was_ignored[i])
            sigaction(watched[i], &action, nullptr);
}

InterruptWatch::~InterruptWatch() {
    for (std::size_t i = 0; i < watched_count; ++i)
        sigaction(watched[i], &before[i], nullptr);
}

bool InterruptWatch::requested() const { return interrupted != 0; }

void InterruptWatch::answer(const char *line) { answer_line = line; }

} // namespace gradus
