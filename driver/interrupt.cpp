#include "driver/interrupt.h"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <system_error>
#include <thread>

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

/// Nanoseconds of the clock when the first signal came; 0: none did.
std::atomic<std::int64_t> first_signal{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free, "a handler may not wait for a lock");

const char *volatile answer_line = nullptr;
struct sigaction before[watched_count];

/// One wish to stop may come as several signals: `timeout` sends one to its child and then one to the whole group, and
/// who forwards a signal sends it once more. Nobody asks for a second time so soon.
constexpr std::int64_t same_wish = 300'000'000; // nanoseconds

std::int64_t nanoseconds_now() {
    struct timespec now = {};
    clock_gettime(CLOCK_MONOTONIC, &now); // which a handler may call
    return std::int64_t(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

// Only calls that a handler may make.
void on_signal(int number) {
    const int error = errno; // of the code that it came between
    const std::int64_t now = nanoseconds_now();
    std::int64_t first = 0;
    if (first_signal.compare_exchange_strong(first, now)) {
        const char *const line = answer_line;
        if (line && write(STDERR_FILENO, line, std::strlen(line)) < 0)
            answer_line = nullptr; // nobody reads it
    } else if (number != SIGHUP && now - first > same_wish) {
        // Comes as soon as this handler returns, and ends the process. A terminal that goes sends SIGHUP by the shell
        // and by the kernel, at any distance, and nobody is there who would be impatient.
        struct sigaction standard = {};
        standard.sa_handler = SIG_DFL;
        sigaction(number, &standard, nullptr);
        raise(number);
    }
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

void take_signals_in_a_thread() {
    try {
        std::thread([] {
            for (;;)
                pause();
        }).detach();
    } catch (const std::system_error &) {
        return;
    }
    sigset_t blocked;
    sigemptyset(&blocked);
    for (const int signal : watched)
        sigaddset(&blocked, signal);
    pthread_sigmask(SIG_BLOCK, &blocked, nullptr);
}

InterruptWatch::InterruptWatch() {
    first_signal = 0;
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

bool InterruptWatch::requested() const { return first_signal != 0; }

void InterruptWatch::answer(const char *line) { answer_line = line; }

} // namespace gradus
