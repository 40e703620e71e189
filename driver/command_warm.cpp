#include "driver/commands.h"
#include "driver/memory_check.h"
#include "driver/method_request.h"
#include "driver/options_of_method.h"
#include "driver/scene_request.h"
#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/scene/own_frame.h"
#include "runtime/seconds_since.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <system_error>

namespace gradus {
namespace {

struct WarmRequest {
    SceneRequest scene;
    MethodRequest method;
};

/// Renders do without a cache; to warm none is a mistake.
void check_cache(const std::filesystem::path &folder) {
    if (folder.empty())
        throw Error(ExitCode::usage, "there is no cache to warm: GRADUS_CACHE_DIR is off, or there is no home (see "
                                     "docs/command-line.md)");
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (access(folder.c_str(), W_OK | X_OK) != 0)
        throw Error(ExitCode::output, fmt::format("cannot keep kernels in '{}': it cannot be written to; "
                                                  "GRADUS_CACHE_DIR names another folder",
                                                  folder.string()));
}

int run_warm(const WarmRequest &request, const Services &services) {
    check_cache(services.cache_folder());
    const auto start = std::chrono::steady_clock::now();
    check_method_options(request.method);
    const auto warn = [](const std::string &warning) { print_message("gradus: warning: " + warning + "\n"); };
    Scene scene = load_requested_scene(for_method(request.scene, request.method.method), services, warn);
    for (const std::string &sentence : unread_options(request.method, request.method.method))
        warn(sentence);
    bring_to_own_frame(scene);
    const std::uint64_t left = bytes_left(request.method.options.threads);
    check_memory(scene, request.method.method, request.method.options, left);
    RenderOptions options = request.method.options;
    options.on_compiled = [](const std::string &kernel, std::size_t ready, std::size_t total, double seconds) {
        print_message(fmt::format("{:8.3f} s  {} ({} of {})\n", seconds, kernel, ready, total));
    };
    const PreparedMethod prepared = services.prepare(request.method.method, request.method.device, scene, options);
    if (const std::optional<MethodChoice> choice = prepared.method->statistics().choice)
        check_memory_of_choice(scene, choice->method, request.method.options, left);
    // Some implementations compile a kernel when it first runs, and once for each shape of its grid: a batch as a
    // render has it meets them all.
    prepared.method->render_batch();
    prepared.method->image(); // and what makes an image of it
    print_message(fmt::format("{:8.3f} s  in all, on {}\n", seconds_since(start), prepared.description.name));
    if (services.programs_not_kept() > 0)
        throw Error(ExitCode::output, fmt::format("not all kernels could be kept in '{}': is the disk full?",
                                                  services.cache_folder().string()));
    return static_cast<int>(ExitCode::success);
}

} // namespace

void add_warm_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("warm", "Compile and cache the kernels of a scene ahead of its renders");
    const auto request = std::make_shared<WarmRequest>();
    command.footer("Give the scene and method options that the render will have, for which kernels are compiled, but\n"
                   "none for how long it takes or what it writes (-o, --layers, --seed, --time, --stats...). A first\n"
                   "batch is rendered and thrown away. Kernels that come from the cache print no line.");
    add_scene_options(command, request->scene);
    add_method_options(command, services, request->method);
    command.callback([request, &command, &services, &chosen] {
        request->method.given = given_options(command);
        chosen = [request, &services] { return run_warm(*request, services); };
    });
}

} // namespace gradus
