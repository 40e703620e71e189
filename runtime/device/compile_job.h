// What a process that compiles is asked, and what it answers.
#pragma once

#include "runtime/device/program_code.h"

#include <string>
#include <string_view>

namespace gradus {

/// A worker of another version answers nothing.
constexpr std::string_view compile_protocol = "gradus compile 1";

/// One program. It is compiled for the device of this description.
struct CompileJob {
    DeviceDescription device;
    ProgramSource source;
};

struct CompileAnswer {
    enum class Kind : unsigned { compiled, does_not_compile, no_code };
    Kind kind = Kind::no_code;
    std::string content; ///< the image's bytes, or the message
    double seconds = 0;
};

std::string to_bytes(const CompileJob &job);
std::string to_bytes(const CompileAnswer &answer);
/// Both throw std::runtime_error for bytes of another kind.
CompileJob compile_job(std::string_view bytes);
CompileAnswer compile_answer(std::string_view bytes);

/// What the program gradus-compile does: compiles what comes over the socket until the other side closes it.
int run_compile_worker(int socket);

} // namespace gradus
