#include "bench/kernels/vector_width.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <string>

#include <unistd.h>

namespace gradus::bench {

namespace {

constexpr const char *remarks_on = "POCL_VECTORIZER_REMARKS";
constexpr std::string_view done = "vectorized loop (vectorization width: ", not_done = "loop not vectorized";

/// What is written to stdout meanwhile.
std::string captured_output(const std::function<void()> &work) {
    std::FILE *file = std::tmpfile();
    std::cout.flush();
    std::fflush(stdout);
    const int terminal = dup(STDOUT_FILENO);
    if (!file || terminal < 0 || dup2(fileno(file), STDOUT_FILENO) < 0)
        return "";
    work();
    std::cout.flush();
    std::fflush(stdout);
    dup2(terminal, STDOUT_FILENO);
    close(terminal);
    std::rewind(file);
    std::string text;
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file))
        text += static_cast<char>(c);
    std::fclose(file);
    return text;
}

} // namespace

std::optional<int> pocl_vector_width(CapturedLaunch &launch) {
    if (launch.device().description().platform.find("Portable") == std::string::npos)
        return std::nullopt;
    // A kernel that no cache holds.
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    Replay replay = launch.replay(Precision::single, {{"COMPILED_AT", std::to_string(now)}});
    setenv(remarks_on, "1", 1);
    const std::string text = captured_output([&] { replay.seconds(); });
    unsetenv(remarks_on);
    int width = 0;
    for (std::size_t at = text.find(done); at != std::string::npos; at = text.find(done, at + 1))
        width = std::max(width, std::atoi(text.c_str() + at + done.size()));
    if (width > 0)
        return width;
    return text.find(not_done) != std::string::npos ? std::optional<int>(1) : std::nullopt;
}

} // namespace gradus::bench
