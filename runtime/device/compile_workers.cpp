#include "runtime/device/compile_workers.h"

#include "runtime/companion_file.h"
#include "runtime/device/cache_folder.h"
#include "runtime/device/framed_socket.h"
#include "runtime/device/spawn_arguments.h"
#include "runtime/seconds_since.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

namespace gradus {

namespace fs = std::filesystem;

namespace {

bool is_program(const fs::path &path) { return !path.empty() && access(path.c_str(), X_OK) == 0; }

/// Seconds after which it is looked at who is late.
constexpr double slice = 0.5;

/// Nobody above asks for warnings, and who waits so long wants to know for what.
std::string told_late(const std::string &kernel, double limit) {
    const std::string message =
        fmt::format("kernel {}: the process that compiles it gave no answer in {:g} s (GRADUS_COMPILE_LIMIT); it was "
                    "ended, and this one compiles the kernel",
                    kernel, limit);
    std::fputs(("gradus: warning: " + message + "\n").c_str(), stderr);
    return message;
}

CompileAnswer received_answer(int socket) {
    std::string message;
    if (!receive_message(socket, message))
        throw std::runtime_error("the worker ended");
    return compile_answer(message);
}

} // namespace

/// A process that compiles. Ended with this object.
class CompileWorker {
  public:
    CompileWorker(const fs::path &program, const fs::path &folder, std::uint32_t work_group_size)
        : work_group_size_(work_group_size) {
        // Each in a folder of its own: processes that share one of PoCL's disturb each other.
        static std::atomic<unsigned> number{0};
        folder_ = folder / ("worker-" + std::to_string(number++));
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
            return;
        std::vector<std::string> arguments = {program.string()};
        std::vector<std::pair<std::string, std::string>> changes = {
            {"POCL_CACHE_DIR", folder_.string()}, {"POCL_BINARY_SPECIALIZE_WG", pocl_specialization(work_group_size)}};
        for (const char *variable : pocl_thread_variables)
            changes.emplace_back(variable, "1"); // it runs nothing
        std::vector<std::string> variables = environment_with(changes);
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, pair[1], STDIN_FILENO);
        // What a compiler prints is none of our output.
        posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
        if (posix_spawn(&process_, program.c_str(), &actions, nullptr, pointers_to(arguments).data(),
                        pointers_to(variables).data()) != 0)
            process_ = -1;
        posix_spawn_file_actions_destroy(&actions);
        close(pair[1]);
        socket_ = pair[0];
        // One that hangs in the middle of a message.
        const timeval limit = {static_cast<time_t>(std::ceil(compile_limit())), 0};
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    }
    ~CompileWorker() { end(); }
    CompileWorker(const CompileWorker &) = delete;
    CompileWorker &operator=(const CompileWorker &) = delete;

    bool lives() const { return process_ > 0; }
    int socket() const { return socket_; }
    std::uint32_t work_group_size() const { return work_group_size_; }
    /// False where it has died, or says what nobody asked.
    bool is_ready() const {
        pollfd state = {socket_, POLLIN, 0};
        return lives() && poll(&state, 1, 0) == 0;
    }
    std::optional<std::size_t> job; ///< what it is busy with
    double seconds = 0;             ///< for how long

    void end() {
        if (socket_ >= 0)
            close(std::exchange(socket_, -1));
        if (!lives())
            return;
        kill(process_, SIGKILL);
        waitpid(std::exchange(process_, -1), nullptr, 0);
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

  private:
    const std::uint32_t work_group_size_;
    pid_t process_ = -1;
    int socket_ = -1;
    fs::path folder_;
};

fs::path compile_worker_program() {
    if (const char *chosen = std::getenv("GRADUS_COMPILE"))
        return is_program(chosen) ? fs::path(chosen) : fs::path();
    const fs::path found = companion_file(GRADUS_COMPILE_OF_BUILD, GRADUS_COMPILE_OF_INSTALLATION);
    return is_program(found) ? found : fs::path();
}

double compile_limit() {
    const char *chosen = std::getenv("GRADUS_COMPILE_LIMIT");
    const double seconds = chosen ? std::strtod(chosen, nullptr) : 0;
    constexpr double most = 1e6; // days, which no type of a limit is too short for
    return seconds > 0 ? std::min(seconds, most) : 120;
}

CompileWorkers::CompileWorkers() = default;
CompileWorkers::~CompileWorkers() = default;

std::unique_ptr<CompileWorker> CompileWorkers::idle_worker(std::uint32_t work_group_size) {
    const std::lock_guard lock(mutex_);
    for (auto worker = idle_.begin(); worker != idle_.end(); ++worker)
        if ((*worker)->work_group_size() == work_group_size && (*worker)->is_ready()) {
            std::unique_ptr<CompileWorker> taken = std::move(*worker);
            idle_.erase(worker);
            return taken;
        }
    return nullptr;
}

void CompileWorkers::compile(const std::vector<CompileJob> &jobs, std::uint32_t work_group_size, unsigned processes,
                             const std::function<void(std::size_t, const CompileAnswer &)> &answered) {
    // The time to compile goes about with the length of the source. The longest first, so that all end together.
    std::vector<std::size_t> waiting(jobs.size());
    std::iota(waiting.begin(), waiting.end(), 0);
    std::stable_sort(waiting.begin(), waiting.end(), [&](std::size_t a, std::size_t b) {
        return jobs[a].source.text.size() < jobs[b].source.text.size(); // taken from the back
    });

    const fs::path program = compile_worker_program(), folder = private_folder();
    std::vector<std::unique_ptr<CompileWorker>> workers;
    const auto give_job = [&](CompileWorker &worker) {
        worker.job.reset();
        if (waiting.empty() || !worker.lives())
            return;
        worker.job = waiting.back();
        worker.seconds = 0;
        waiting.pop_back();
        send_message(worker.socket(), to_bytes(jobs[*worker.job])); // a failure is seen when it should answer
    };
    if (!program.empty() && !folder.empty())
        for (unsigned i = 0; i < std::min<std::size_t>(processes, jobs.size()); ++i) {
            std::unique_ptr<CompileWorker> worker = idle_worker(work_group_size);
            workers.push_back(worker ? std::move(worker)
                                     : std::make_unique<CompileWorker>(program, folder, work_group_size));
            give_job(*workers.back());
        }

    const double limit = compile_limit();
    for (;;) {
        std::vector<pollfd> sockets;
        std::vector<CompileWorker *> polled;
        for (const std::unique_ptr<CompileWorker> &worker : workers)
            if (worker->lives() && worker->job) {
                sockets.push_back({worker->socket(), POLLIN, 0});
                polled.push_back(worker.get());
            }
        if (sockets.empty())
            break;
        const auto start = std::chrono::steady_clock::now();
        const int ready = poll(sockets.data(), sockets.size(), int(1000 * slice));
        // A process that was stopped for long has not waited for as long.
        const double waited = std::min(seconds_since(start), slice);
        for (std::size_t i = 0; i < sockets.size(); ++i) {
            CompileWorker &worker = *polled[i];
            worker.seconds += waited;
            const bool is_late = worker.seconds > limit;
            if (!is_late && (ready <= 0 || sockets[i].revents == 0)) // ready < 0: a signal
                continue;
            const std::size_t job = *worker.job;
            CompileAnswer answer;
            try {
                if (is_late)
                    throw std::runtime_error(told_late(jobs[job].source.name, limit));
                answer = received_answer(worker.socket());
                give_job(worker); // before its answer is worked on here
            } catch (const std::runtime_error &error) {
                answer.content = error.what();
                worker.end();
            }
            answered(job, answer);
        }
    }
    for (const std::size_t job : waiting) // no worker was left
        answered(job, {});
    const std::lock_guard lock(mutex_);
    for (std::unique_ptr<CompileWorker> &worker : workers)
        if (worker->lives())
            idle_.push_back(std::move(worker));
}

} // namespace gradus
