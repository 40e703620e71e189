#include "driver/commands.h"
#include "driver/device_options.h"
#include "driver/memory_check.h"
#include "driver/scene_request.h"
#include "driver/standard_streams.h"
#include "driver/tuning_store.h"
#include "runtime/error.h"
#include "runtime/scene/own_frame.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace gradus {
namespace {

struct TuneRequest {
    SceneRequest scene;
    std::string device;
    int threads = 0;
};

void print_trial(const TuningTrial &trial) {
    std::string text;
    if (!trial.failure.empty())
        text = "not possible: " + trial.failure.substr(0, trial.failure.find('\n'));
    else if (!trial.same_image)
        text = "another image: thrown out";
    else
        text = fmt::format("{:.3f} times as fast ({:.3f} to {:.3f})", trial.median_gain,
                           *std::min_element(trial.gains.begin(), trial.gains.end()),
                           *std::max_element(trial.gains.begin(), trial.gains.end()));
    print_message(fmt::format("{:<44} {}\n", name_of(trial.tuning), text));
}

int run_tune(const TuneRequest &request, const Services &services) {
    check_tuning_file();
    Scene scene = load_requested_scene(request.scene, services, [](const std::string &warning) {
        print_message("gradus: warning: " + warning + "\n");
    });
    bring_to_own_frame(scene);
    RenderOptions of_renders;
    of_renders.threads = request.threads;
    check_memory(scene, "pt", of_renders, bytes_left(request.threads));
    TuningOptions options;
    options.threads = request.threads;
    options.on_trial = print_trial;
    const TunedDevice tuned = services.tune(request.device, request.threads, scene, options);
    store_tuning(tuned.description, tuned.report.chosen);
    print_result(fmt::format("{}: {}{}; kept in {}\n", tuned.description.name, name_of(tuned.report.chosen),
                             tuned.report.chosen == Tuning{} ? ", for nothing gains" : "", tuning_file()));
    return static_cast<int>(ExitCode::success);
}

} // namespace

void add_tune_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand(
        "tune", "Find the work-group and batch size that render fastest on a device, and keep them for it");
    const auto request = std::make_shared<TuneRequest>();
    command.footer("Renders the scene with one candidate after the other, for about half a minute. Later renders on\n"
                   "this device use what was found; their images are the same bit for bit.");
    add_scene_options(command, request->scene);
    add_device_options(command, "Options", request->device, request->threads);
    command.callback(
        [request, &services, &chosen] { chosen = [request, &services] { return run_tune(*request, services); }; });
}

} // namespace gradus
