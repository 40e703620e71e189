#include "runtime/device/compile_workers.h"

#include "runtime/device/cache_folder.h"
#include "runtime/device/framed_socket.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
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

/// This process's variables with others set.
std::vector<std::string> environment_with(const std::vector<std::pair<std::string, std::string>> &changes) {
    std::vector<std::string> variables;
    for (char **variable = environ; variable && *variable; ++variable)
        if (std::none_of(changes.begin(), changes.end(), [&](const auto &change) {
                return std::string_view(*variable).starts_with(change.first + '=');
            }))
            variables.emplace_back(*variable);
    for (const auto &[name, value] : changes)
        variables.push_back(name + '=' + value);
    return variables;
}

std::vector<char *> pointers_to(std::vector<std::string> &texts) {
    std::vector<char *> pointers;
    for (std::string &text : texts)
        pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
}

/// A process that compiles. Ended with this object.
class Worker {
  public:
    Worker(const fs::path &program, const fs::path &folder, std::uint32_t work_group_size) {
        // Each in a folder of its own: processes that share one of PoCL's disturb each other.
        static std::atomic<unsigned> number{0};
        folder_ = folder / ("worker-" + std::to_string(number++));
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
            return;
        std::vector<std::string> arguments = {program.string()};
        std::vector<std::string> variables =
            environment_with({{"POCL_CACHE_DIR", folder_.string()},
                              {"POCL_MAX_PTHREAD_COUNT", "1"}, // it runs nothing
                              {"POCL_BINARY_SPECIALIZE_WG", pocl_specialization(work_group_size)}});
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
    }
    ~Worker() { end(); }
    Worker(const Worker &) = delete;
    Worker &operator=(const Worker &) = delete;

    bool lives() const { return process_ > 0; }
    int socket() const { return socket_; }
    std::optional<std::size_t> job; ///< what it is busy with

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
    pid_t process_ = -1;
    int socket_ = -1;
    fs::path folder_;
};

CompileAnswer received_answer(int socket) {
    std::string message;
    if (!receive_message(socket, message))
        throw std::runtime_error("the worker ended");
    return compile_answer(message);
}

} // namespace

fs::path compile_worker_program() {
    if (const char *chosen = std::getenv("GRADUS_COMPILE"))
        return is_program(chosen) ? fs::path(chosen) : fs::path();
    std::error_code failure;
    const fs::path folder = fs::read_symlink("/proc/self/exe", failure).parent_path();
    for (const fs::path &place : {folder / "gradus-compile", folder / "../libexec/gradus/gradus-compile",
                                  fs::path(GRADUS_COMPILE_OF_BUILD), fs::path(GRADUS_COMPILE_OF_INSTALLATION)})
        if (is_program(place))
            return place;
    return {};
}

void compile_in_processes(const std::vector<CompileJob> &jobs, std::uint32_t work_group_size, unsigned processes,
                          const std::function<void(std::size_t, const CompileAnswer &)> &answered) {
    // The time to compile goes about with the length of the source. The longest first, so that all end together.
    std::vector<std::size_t> waiting(jobs.size());
    std::iota(waiting.begin(), waiting.end(), 0);
    std::stable_sort(waiting.begin(), waiting.end(), [&](std::size_t a, std::size_t b) {
        return jobs[a].source.text.size() < jobs[b].source.text.size(); // taken from the back
    });

    const fs::path program = compile_worker_program(), folder = private_folder();
    std::vector<std::unique_ptr<Worker>> workers;
    const auto give_job = [&](Worker &worker) {
        if (waiting.empty() || !worker.lives())
            return worker.end();
        worker.job = waiting.back();
        waiting.pop_back();
        send_message(worker.socket(), to_bytes(jobs[*worker.job])); // a failure is seen when it should answer
    };
    if (!program.empty() && !folder.empty())
        for (unsigned i = 0; i < std::min<std::size_t>(processes, jobs.size()); ++i) {
            workers.push_back(std::make_unique<Worker>(program, folder, work_group_size));
            give_job(*workers.back());
        }

    for (;;) {
        std::vector<pollfd> sockets;
        std::vector<Worker *> polled;
        for (const std::unique_ptr<Worker> &worker : workers)
            if (worker->lives()) {
                sockets.push_back({worker->socket(), POLLIN, 0});
                polled.push_back(worker.get());
            }
        if (sockets.empty())
            break;
        if (poll(sockets.data(), sockets.size(), -1) < 0)
            continue; // a signal
        for (std::size_t i = 0; i < sockets.size(); ++i) {
            if (sockets[i].revents == 0)
                continue;
            Worker &worker = *polled[i];
            const std::size_t job = *worker.job;
            CompileAnswer answer;
            try {
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
}

} // namespace gradus
