#include "driver/program.h"

#include "driver/commands.h"
#include "driver/interrupt.h"
#include "driver/memory_check.h"
#include "driver/standard_streams.h"
#include "driver/usage_message.h"
#include "runtime/error.h"
#include "runtime/version.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <new>
#include <sstream>
#include <string_view>
#include <system_error>

namespace gradus {
namespace {

constexpr const char *description =
    "gradus renders Mitsuba scene files with OpenCL kernels, and reconstructs images from gradients.";

constexpr const char *examples = R"(Examples:
  gradus render scene.xml -o out.exr                      as the file says
  gradus render scene.xml -o out.exr --spp 256 --png      more samples, and a PNG to look at
  gradus render scene.xml -o out.exr --time 60            as good as it gets in a minute
  gradus inspect scene.xml                                what the scene holds
  gradus plugins                                          what scene files may say
  gradus solve layers.exr -o out.exr                      an image from its gradients
  gradus compare out.exr reference.exr                    how far from the truth
  gradus warm scene.xml                                   compile the kernels ahead
  gradus tune scene.xml                                   find what renders fastest on this device
  gradus devices                                          the OpenCL devices of this machine

`gradus COMMAND --help` explains the options of a command.

Exit codes: 0 success, 1 failure (also: a comparison with --check that does not hold), 2 command line,
3 scene file, 4 device or memory, 5 output that cannot be written, 6 input image, 130 interrupted (a valid
image of the samples so far was written, if there were any).)";

int no_more_threads(const std::exception &error) {
    print_message(
        fmt::format("gradus: error: {}: not enough memory, or too many threads: try --nthreads 1\n", error.what()));
    return static_cast<int>(ExitCode::device);
}

int run_chosen(const std::function<int()> &chosen) {
    try {
        return chosen();
    } catch (const Error &error) {
        print_message(fmt::format("gradus: error: {}\n", error.what()));
        return static_cast<int>(error.code);
    } catch (const std::bad_alloc &) {
        print_message("gradus: error: out of memory: try a smaller --size, a --crop, or a smaller --batch-size\n");
        return static_cast<int>(ExitCode::device);
    } catch (const std::system_error &error) {
        // A thread or a process that could not be started.
        if (error.code() == std::errc::resource_unavailable_try_again || error.code() == std::errc::not_enough_memory)
            return no_more_threads(error);
        print_message(fmt::format("gradus: error: {}\n", error.what()));
    } catch (const std::exception &error) {
        // So says TBB that it could not start a thread.
        if (std::string_view(error.what()).find("pthread_create") != std::string_view::npos)
            return no_more_threads(error);
        print_message(fmt::format("gradus: error: {}\n", error.what()));
    } catch (...) {
        print_message("gradus: error: an exception of unknown type\n");
    }
    return static_cast<int>(ExitCode::failure);
}

/// Where the process was started without them, files that it opens would take the places of stdin, stdout and stderr,
/// and other processes' output would go there. Reading finds an end; writing fails, as it does without them.
void keep_standard_descriptors() {
    for (int descriptor = 0; descriptor <= STDERR_FILENO; ++descriptor)
        if (fcntl(descriptor, F_GETFD) == -1)
            open("/dev/null", O_RDONLY); // takes the least number that is free
}

/// An empty value is that of a variable that is not set. What it was to say would be lost, or become something else, as
/// an empty folder is the working one.
void refuse_empty_values(CLI::App &app) {
    const auto complaint = [](const std::string &value) {
        return std::string(value.empty() ? "must not be empty" : "");
    };
    for (CLI::App *command : app.get_subcommands([](const CLI::App *) { return true; }))
        for (CLI::Option *option : command->get_options())
            if (option->get_items_expected_max() > 0) // no flag
                option->check(complaint);
}

} // namespace

const char *version() { return GRADUS_VERSION; }

int run_program(int argc, const char *const *argv, const Services &services) {
    // A file over the size limit and a reader that went away shall be errors of the call, not the end of the process.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    // Where the process was started to ignore it, nobody who starts others, as PoCL does its linker, learns how they
    // end.
    std::signal(SIGCHLD, SIG_DFL);
    spare_address_space();
    take_signals_in_a_thread();
    keep_standard_descriptors();

    std::function<int()> chosen;
    try {
        CLI::App app{description, "gradus"};
        app.set_version_flag("--version", fmt::format("gradus {}", version()));
        app.require_subcommand(1);
        app.footer(examples);
        app.failure_message(usage_message);
        add_render_command(app, services, chosen);
        add_inspect_command(app, services, chosen);
        add_plugins_command(app, chosen);
        add_devices_command(app, services, chosen);
        add_compare_command(app, chosen);
        add_solve_command(app, services, chosen);
        add_warm_command(app, services, chosen);
        add_tune_command(app, services, chosen);
        refuse_empty_values(app);
        try {
            app.parse(argc, argv);
        } catch (const CLI::ParseError &error) {
            std::ostringstream help, complaint;
            const bool is_help = app.exit(error, help, complaint) == 0;
            print_message(complaint.str());
            return run_chosen([&] {
                print_result(help.str());
                return static_cast<int>(is_help ? ExitCode::success : ExitCode::usage);
            });
        }
        // Run after parsing, while the options that the command refers to are alive.
        return run_chosen(chosen);
    } catch (const std::exception &error) {
        print_message(fmt::format("gradus: error: {}\n", error.what()));
        return static_cast<int>(ExitCode::failure);
    }
}

} // namespace gradus
