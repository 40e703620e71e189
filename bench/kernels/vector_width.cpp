#include "bench/kernels/vector_width.h"

#include "runtime/device/spawn_arguments.h"
#include "runtime/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gradus::bench {

namespace {

constexpr std::string_view begin_mark = "\n=== kernel ", end_mark = "\n=== end\n";
constexpr std::string_view vectorised = "vectorized loop (vectorization width: ";

bool is_pocl(const Device &device) { return device.description().platform.find("Portable") != std::string::npos; }

/// What this program prints, called with these arguments, without caches of kernels, which would leave out PoCL's
/// remarks. Throws Error where it fails.
std::string own_output(std::vector<std::string> arguments) {
    std::vector<std::string> environment =
        environment_with({{"GRADUS_CACHE_DIR", "off"}, {"POCL_KERNEL_CACHE", "0"}, {"POCL_VECTORIZER_REMARKS", "1"}});
    arguments.insert(arguments.begin(), "/proc/self/exe");
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw Error(ExitCode::failure, fmt::format("no pipe for the vectoriser's remarks: {}", std::strerror(errno)));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    pid_t process;
    const std::string program = std::filesystem::read_symlink(arguments.front());
    const int failure = posix_spawn(&process, program.c_str(), &actions, nullptr, pointers_to(arguments).data(),
                                    pointers_to(environment).data());
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    std::string text;
    char some[4096];
    for (ssize_t count; failure == 0 && (count = read(ends[0], some, sizeof some)) != 0;) {
        if (count > 0)
            text.append(some, std::size_t(count));
        else if (errno != EINTR)
            break;
    }
    close(ends[0]);
    if (failure != 0)
        throw Error(ExitCode::failure, fmt::format("cannot run {}: {}", program, std::strerror(failure)));
    int status = 0;
    while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        throw Error(ExitCode::failure,
                    fmt::format("{} --parts remarks failed; --no-vectoriser does without. It ends with\n{}", program,
                                text.substr(text.size() - std::min<std::size_t>(text.size(), 500))));
    return text;
}

} // namespace

std::map<KernelPlace, int> pocl_vector_widths(const Settings &settings) {
    std::map<KernelPlace, int> widths;
    if (!is_pocl(settings.device))
        return widths;
    const std::string text =
        own_output({"--parts", "remarks", "--queue-bits", "8", "--scene", settings.scene, "--device",
                    settings.device.description().name, "--nthreads", std::to_string(settings.threads), "--kinds",
                    fmt::format("{}", fmt::join(settings.kinds, ",")), "--methods",
                    fmt::format("{}", fmt::join(settings.methods, ","))});
    for (std::size_t at = text.find(begin_mark); at != std::string::npos; at = text.find(begin_mark, at + 1)) {
        const std::size_t name = at + begin_mark.size(), line_end = text.find('\n', name),
                          end = text.find(end_mark, at);
        if (end == std::string::npos)
            break;
        const std::size_t space = text.find(' ', name); // the file's name has none, that of the kernel may have
        int &width = widths[{text.substr(name, space - name), text.substr(space + 1, line_end - space - 1)}] = 1;
        for (std::size_t found = text.find(vectorised, at); found < end; found = text.find(vectorised, found + 1))
            width = std::max(width, std::atoi(text.c_str() + found + vectorised.size()));
    }
    return widths;
}

void print_remarks(CapturedLaunch &launch) {
    // A definition of its own: else it would be the program that the device has already.
    Replay replay = launch.replay(Precision::single, {{"WITH_REMARKS", "1"}});
    fmt::print("{}{} {}\n", begin_mark, launch.file(), launch.name());
    std::fflush(stdout);
    replay.seconds();
    std::cout.flush(); // which the compiler writes to
    fmt::print("{}", end_mark);
    std::fflush(stdout);
}

} // namespace gradus::bench
