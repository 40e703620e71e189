// The error that a user can mend. Its message says what is wrong, where, and what to do; the driver prints it and
// exits with its code.
#pragma once

#include <stdexcept>
#include <string>

namespace gradus {

/// Exit codes of the gradus program.
enum class ExitCode : int {
    success = 0,
    failure = 1,      ///< anything without a code of its own
    usage = 2,        ///< the command line
    scene = 3,        ///< a scene file, or a file that it names
    device = 4,       ///< no OpenCL device, a kernel that does not build, or not enough memory
    output = 5,       ///< an output that cannot be written
    image = 6,        ///< an input image that cannot be read or does not fit
    interrupted = 130 ///< Ctrl-C or SIGTERM; a valid partial image was written
};

class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string &message) : std::runtime_error(message), code(code) {}
    const ExitCode code;
};

} // namespace gradus
