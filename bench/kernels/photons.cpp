// Gathering and manifold walks as methods launch them, by the times of their stages: pairs of gather point and photon a
// second over those that a triad's bandwidth would allow, and nanoseconds of the walks' kernels a ray, without Embree.
#include "bench/kernels/interleaved.h"
#include "bench/kernels/measurements.h"
#include "bench/spread.h"
#include "planning/make_method.h"
#include "runtime/io/load_scene.h"

#include <fmt/format.h>

#include <map>
#include <memory>

namespace gradus::bench {

namespace {

/// What all stages together read and write for a pair, each column once a stage: of photons, position, normal, depth
/// and line to count and again to list them, direction, normal and power to evaluate; the pair, written and read; its
/// value, written and read. Gather points, read once for all their pairs, are left out.
constexpr double bytes_a_pair = 4 * (8 + 8 + 9 + 2 * 2 + 2 * 3);

std::unique_ptr<Method> method_of(const Settings &settings, const char *name, const char *file, std::uint32_t size,
                                  std::uint64_t light_paths, double radius) {
    Scene scene = load_scene(std::string(GRADUS_SCENES) + "/" + file).scene;
    scene.film.width = scene.film.height = size;
    scene.film.crop_x = scene.film.crop_y = scene.film.crop_width = scene.film.crop_height = 0;
    scene.settings.samples_per_pixel = 1'000'000;
    RenderOptions options;
    options.photons = light_paths;
    options.radius = RenderOptions::GatherRadius{radius, false};
    return make_method(name, settings.device, scene, options);
}

/// Seconds of the stages whose names begin with one of `names`.
double seconds_of(const Statistics &statistics, const std::vector<std::string> &names) {
    double seconds = 0;
    for (const StageTime &stage : statistics.stages)
        for (const std::string &name : names)
            seconds += stage.name.starts_with(name) ? stage.seconds : 0;
    return seconds;
}

/// One pass of `method` more.
void render_pass(Method &method) {
    const std::uint64_t pixels = method.total_samples() / 1'000'000, aim = method.done_samples() + pixels;
    while (method.done_samples() < aim)
        method.render_batch();
}

nlohmann::json measure_gathering(const Settings &settings, double radius) {
    const std::unique_ptr<Method> method = method_of(settings, "sppm", "cornell-box.xml", 256, 500'000, radius);
    render_pass(*method);
    const auto pairs_a_pass = double(method->statistics().photon_pairs);
    Triad triad(settings.device, bytes_a_pair * pairs_a_pass);
    const std::vector<std::string> stages = {"photon_pairs", "pair_", "photon_evaluate"};
    double pairs = 0;
    std::map<std::string, std::function<double()>> functions;
    functions["gather"] = [&] {
        const Statistics before = method->statistics();
        render_pass(*method);
        const Statistics after = method->statistics();
        pairs = double(after.photon_pairs - before.photon_pairs);
        return (seconds_of(after, stages) - seconds_of(before, stages)) / pairs;
    };
    functions["triad"] = [&] { return triad.seconds() * bytes_a_pair / triad.bytes(); };
    const auto found = run_interleaved(functions, settings.repeats);
    const double gather = median(found.at("gather")), bound = median(found.at("triad"));
    fmt::print(
        "  radius {:3} pixels: {:5.1f} pairs a gather point, {:6.2f} ns a pair; a triad of its {} bytes {:5.2f}: "
        "{:.0f} %\n",
        radius, pairs / (256 * 256), 1e9 * gather, bytes_a_pair, 1e9 * bound, 100 * bound / gather);
    return {{"radius", radius},
            {"pairs", pairs},
            {"seconds_a_pair", spread(found.at("gather"))},
            {"triad_seconds_a_pair", spread(found.at("triad"))},
            {"share_of_triad", bound / gather}};
}

nlohmann::json measure_walks(const Settings &settings, const char *file) {
    const std::unique_ptr<Method> method = method_of(settings, "gpm", file, 128, 100'000, 0.5);
    render_pass(*method);
    std::vector<double> kernels;
    double steps = 0, walks = 0, arrived = 0, rays = 0;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        const Statistics before = method->statistics();
        render_pass(*method);
        const Statistics after = method->statistics();
        const auto more = [&](const char *what) { return double(after.walks.at(what) - before.walks.at(what)); };
        steps += more("steps");
        arrived += more("arrived");
        for (const auto &[what, count] : after.walks)
            walks += what == "steps" ? 0 : double(count - before.walks.at(what));
        rays += double(after.rays.at("walk") - before.rays.at("walk"));
        kernels.push_back((seconds_of(after, {"walk "}) - seconds_of(before, {"walk "})) /
                          double(after.rays.at("walk") - before.rays.at("walk")));
    }
    fmt::print("  {}: {:.0f} walks a pass, {:.1f} % arrive, {:.2f} steps each; kernels {:.0f} ns a ray\n", file,
               walks / settings.repeats, 100 * arrived / walks, steps / arrived, 1e9 * median(kernels));
    return {{"scene", file},
            {"walks_a_pass", walks / settings.repeats},
            {"arrived", arrived / walks},
            {"steps", steps / arrived},
            {"rays_a_walk", rays / walks},
            {"kernel_seconds_a_ray", spread(kernels)}};
}

} // namespace

nlohmann::json measure_photons(const Settings &settings) {
    fmt::print("Gathering, Cornell box, 256 x 256, 500 000 light paths\n");
    nlohmann::json result = {{"bytes_a_pair", bytes_a_pair}};
    for (const double radius : {2.0, 6.0})
        if (!settings.is_quick || radius < 3)
            result["gathering"].push_back(measure_gathering(settings, radius));
    fmt::print("Manifold walks of gpm, 100 000 light paths\n");
    for (const char *file : {"lamp-in-egg.xml", "slab-and-ball.xml"})
        if (!settings.is_quick || file[0] == 'l')
            result["walks"].push_back(measure_walks(settings, file));
    return result;
}

} // namespace gradus::bench
