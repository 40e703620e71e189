#include "driver/standard_streams.h"

#include "runtime/error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace gradus {

void print_result(const std::string &text) {
    if (std::fputs(text.c_str(), stdout) < 0 || std::fflush(stdout) != 0)
        throw Error(ExitCode::output, std::string("cannot write to the standard output: ") + std::strerror(errno));
}

void print_message(const std::string &text) {
    std::fputs(text.c_str(), stderr);
    std::fflush(stderr);
}

} // namespace gradus
