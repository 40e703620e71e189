// The `gradus` program: reads the command line and runs one command.
#pragma once

#include "driver/services.h"

namespace gradus {

/// The version that the program prints and writes into its files, "0.1.0".
const char *version();

/// Runs the command that the arguments name and returns the exit code of the process (ExitCode). Prints errors to
/// stderr; throws nothing.
int run_program(int argc, const char *const *argv, const Services &services);

} // namespace gradus
