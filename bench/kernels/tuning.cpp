// What the tuner gains on the scene, and whether that holds when it is measured anew: of several candidates the one
// that chance favoured looks best.
#include "bench/kernels/measurements.h"
#include "bench/spread.h"
#include "planning/tuner.h"
#include "runtime/io/load_scene.h"

#include <fmt/format.h>

namespace gradus::bench {

namespace {

nlohmann::json to_json(const TuningTrial &trial) {
    nlohmann::json json = {{"work_group_size", trial.tuning.work_group_size},
                           {"batch_size", trial.tuning.batch_size},
                           {"same_image", trial.same_image}};
    if (!trial.gains.empty())
        json["tuned_over_default"] = spread(trial.gains);
    if (!trial.failure.empty())
        json["failure"] = trial.failure;
    return json;
}

void print(const TuningTrial &trial) {
    fmt::print("  {:<40} ", name_of(trial.tuning));
    if (!trial.failure.empty())
        fmt::print("not possible\n");
    else if (!trial.same_image)
        fmt::print("ANOTHER IMAGE\n");
    else
        fmt::print("{:.3f} ({:.3f} to {:.3f}) of the default's rate\n", median(trial.gains),
                   *std::min_element(trial.gains.begin(), trial.gains.end()),
                   *std::max_element(trial.gains.begin(), trial.gains.end()));
}

} // namespace

nlohmann::json measure_tuning(const Settings &settings) {
    Scene scene = load_scene(settings.scene).scene;
    scene.film.width = scene.film.height = 256;
    scene.film.crop_x = scene.film.crop_y = scene.film.crop_width = scene.film.crop_height = 0;
    TuningOptions options;
    options.turns = settings.repeats;
    options.seconds_a_turn = settings.is_quick ? 0.05 : 0.3;
    options.on_trial = print;
    fmt::print("\nTuning, pt\n");
    const TuningReport report = tune(settings.device, "pt", scene, options);
    nlohmann::json json = {{"work_group_size", report.chosen.work_group_size},
                           {"batch_size", report.chosen.batch_size}};
    for (const TuningTrial &trial : report.trials)
        json["trials"].push_back(to_json(trial));
    if (report.chosen == Tuning{}) {
        fmt::print("  no candidate gains 3 %: the defaults stay, tuning gains nothing on this device\n");
        json["tuned_over_default"] = {{"median", 1.0}, {"least", 1.0}, {"largest", 1.0}};
        return json;
    }
    options.turns = 2 * settings.repeats + 1;
    fmt::print("  the chosen one anew:\n");
    const TuningTrial again = try_tuning(settings.device, "pt", scene, report.chosen, options);
    json["tuned_over_default"] = spread(again.gains);
    if (median(again.gains) < 1.03)
        fmt::print("  measured anew it gains less than 3 %: as good as nothing on this device\n");
    return json;
}

} // namespace gradus::bench
