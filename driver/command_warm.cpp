#include "driver/commands.h"
#include "driver/memory_check.h"
#include "driver/method_request.h"
#include "driver/options_of_method.h"
#include "driver/scene_request.h"
#include "driver/standard_streams.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <chrono>
#include <memory>

namespace gradus {
namespace {

struct WarmRequest {
    SceneRequest scene;
    MethodRequest method;
};

int run_warm(const WarmRequest &request, const Services &services) {
    const auto start = std::chrono::steady_clock::now();
    check_method_options(request.method);
    const auto warn = [](const std::string &warning) { print_message("gradus: warning: " + warning + "\n"); };
    const Scene scene = load_requested_scene(for_method(request.scene, request.method.method), services, warn);
    for (const std::string &sentence : unread_options(request.method, request.method.method))
        warn(sentence);
    check_memory(scene, request.method.options);
    RenderOptions options = request.method.options;
    options.on_compiled = [](const std::string &kernel, std::size_t ready, std::size_t total, double seconds) {
        print_message(fmt::format("{:8.3f} s  {} ({} of {})\n", seconds, kernel, ready, total));
    };
    const PreparedMethod prepared = services.prepare(request.method.method, request.method.device, scene, options);
    // Some implementations compile a kernel when it first runs, and once for each shape of its grid: a batch as a
    // render has it meets them all.
    prepared.method->render_batch();
    prepared.method->image(); // and what makes an image of it
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    print_message(fmt::format("{:8.3f} s  in all, on {}\n", seconds, prepared.description.name));
    return static_cast<int>(ExitCode::success);
}

} // namespace

void add_warm_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("warm", "Compile and cache the kernels of a scene ahead of its renders");
    const auto request = std::make_shared<WarmRequest>();
    command.footer("Give the options that the render will have: a kernel is compiled for what they ask for. A first\n"
                   "batch is rendered and thrown away. Kernels that come from the cache print no line.");
    add_scene_options(command, request->scene);
    add_method_options(command, services, request->method);
    command.callback([request, &command, &services, &chosen] {
        request->method.given = given_options(command);
        chosen = [request, &services] { return run_warm(*request, services); };
    });
}

} // namespace gradus
