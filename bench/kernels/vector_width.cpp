#include "bench/kernels/vector_width.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>

#include <unistd.h>

namespace gradus::bench {

namespace {

constexpr std::string_view begin_mark = "\n=== kernel ", end_mark = "\n=== end\n";
constexpr std::string_view vectorised = "vectorized loop (vectorization width: ";

bool is_pocl(const Device &device) { return device.description().platform.find("Portable") != std::string::npos; }

std::string output_of(const std::string &command) {
    std::string text;
    std::FILE *pipe = popen(command.c_str(), "r");
    if (!pipe)
        return text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
        text += static_cast<char>(c);
    pclose(pipe);
    return text;
}

} // namespace

std::map<std::string, int> pocl_vector_widths(const Settings &settings) {
    std::map<std::string, int> widths;
    if (!is_pocl(settings.device))
        return widths;
    const std::string text =
        output_of(fmt::format("GRADUS_CACHE_DIR=off POCL_VECTORIZER_REMARKS=1 /proc/{}/exe --parts remarks "
                              "--queue-bits 8 --scene '{}' --device '{}' --kinds {} "
                              "--methods {} 2>&1",
                              getpid(), settings.scene, settings.device.description().name,
                              fmt::join(settings.kinds, ","), fmt::join(settings.methods, ",")));
    for (std::size_t at = text.find(begin_mark); at != std::string::npos; at = text.find(begin_mark, at + 1)) {
        const std::size_t name = at + begin_mark.size(), line_end = text.find('\n', name),
                          end = text.find(end_mark, at);
        if (end == std::string::npos)
            break;
        int &width = widths[text.substr(name, line_end - name)] = 1;
        for (std::size_t found = text.find(vectorised, at); found < end; found = text.find(vectorised, found + 1))
            width = std::max(width, std::atoi(text.c_str() + found + vectorised.size()));
    }
    return widths;
}

void print_remarks(CapturedLaunch &launch) {
    // A definition of its own, so that no cache holds the kernel.
    const auto now = std::chrono::system_clock::now().time_since_epoch().count();
    Replay replay = launch.replay(Precision::single, {{"COMPILED_AT", std::to_string(now)}});
    fmt::print("{}{}\n", begin_mark, launch.name());
    std::fflush(stdout);
    replay.seconds();
    std::cout.flush(); // which the compiler writes to
    fmt::print("{}", end_mark);
    std::fflush(stdout);
}

} // namespace gradus::bench
