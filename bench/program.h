// What the programs of the benchmarks have in common: the options that all of them take, and how they end.
#pragma once

#include "runtime/error.h"

#include <CLI/CLI.hpp>

#include <exception>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <string>

namespace gradus::bench {

struct ProgramOptions {
    int threads = 0; ///< of the processor; 0: all
    std::string device, json;
};

/// Nothing, or why figures cannot be written to this file. An old one stays as it is.
inline std::string check_output(const std::string &path) {
    std::error_code none; // then opening fails, too
    const bool is_new = !std::filesystem::exists(path, none);
    if (!std::ofstream(path, std::ios::app))
        return "cannot write " + path;
    if (is_new)
        std::filesystem::remove(path, none);
    return "";
}

inline void add_program_options(CLI::App &app, ProgramOptions &options) {
    app.add_option("--nthreads", options.threads, "Processor threads; 0: all")->check(CLI::Range(0, 4096));
    app.add_option("--device", options.device, "OpenCL device, as gradus takes it");
    app.add_option("--json", options.json, "Also write all figures to this file")->check(check_output);
}

/// Reads the command line and runs. Returns the exit code of the process; what is thrown is printed under the app's
/// name.
inline int run_program(CLI::App &app, int argc, char **argv, const std::function<void()> &run) {
    CLI11_PARSE(app, argc, argv);
    try {
        run();
        return static_cast<int>(ExitCode::success);
    } catch (const Error &error) {
        std::cerr << app.get_name() << ": error: " << error.what() << "\n";
        return static_cast<int>(error.code);
    } catch (const std::exception &error) {
        std::cerr << app.get_name() << ": error: " << error.what() << "\n";
        return static_cast<int>(ExitCode::failure);
    }
}

} // namespace gradus::bench
