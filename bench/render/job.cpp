#include "bench/render/job.h"
#include "planning/make_method.h"

#include "methods/gradient_path_tracer.h"
#include "runtime/error.h"
#include "runtime/io/load_scene.h"

#include <fmt/format.h>

#include <filesystem>

namespace gradus::bench {

namespace {

constexpr int compared_depth = 13, no_roulette = 1'000'000;

/// "cornell-box/scene.xml" is named "cornell-box", "torus-rough-glass.xml" is "torus-rough-glass".
std::string short_name(const std::filesystem::path &path) {
    const std::string stem = path.stem().string();
    return stem == "scene" ? path.parent_path().filename().string() : stem;
}

} // namespace

Job load_job(const std::string &path, std::uint32_t width, std::uint32_t height, std::uint64_t samples_per_pixel,
             bool roulette) {
    Job job{short_name(path), load_scene(path).scene};
    job.scene.film.width = width;
    job.scene.film.height = height;
    job.scene.film.crop_x = job.scene.film.crop_y = job.scene.film.crop_width = job.scene.film.crop_height = 0;
    job.scene.settings.samples_per_pixel = samples_per_pixel;
    if (!roulette) {
        job.scene.settings.max_depth = compared_depth;
        job.scene.settings.rr_depth = no_roulette;
    }
    const RenderSettings &s = job.scene.settings;
    job.name += fmt::format(" {}x{} {} spp, depth {}, {}", width, height, samples_per_pixel, s.max_depth,
                            s.rr_depth == no_roulette ? "no roulette" : fmt::format("roulette from {}", s.rr_depth));
    return job;
}

std::uint64_t Render::rays() const {
    std::uint64_t sum = 0;
    for (const auto &[kind, count] : statistics.rays)
        sum += count;
    return sum;
}

double Render::kernel_seconds() const {
    double sum = 0;
    for (const StageTime &stage : statistics.stages)
        if (stage.name != "trace" && stage.name != "launch and wait")
            sum += stage.seconds;
    return sum;
}

double Render::stage_seconds(const std::string &name) const {
    for (const StageTime &stage : statistics.stages)
        if (stage.name == name)
            return stage.seconds;
    return 0;
}

std::unique_ptr<Method> method_of(const Settings &settings, const Job &job, const RenderOptions &options) {
    return make_method(settings.method, settings.device, job.scene, options);
}

Render render(const Settings &settings, const Job &job, const RenderOptions &options,
              const std::function<void(Method &)> &prepare) {
    RenderOptions own = options;
    own.threads = settings.threads;
    const std::unique_ptr<Method> method = method_of(settings, job, own);
    if (prepare)
        prepare(*method);
    while (method->render_batch()) {
    }
    Render result;
    result.image = method->image();
    result.statistics = method->statistics();
    if (result.statistics.non_finite > 0)
        throw Error(ExitCode::failure,
                    fmt::format("{}: {} samples were not finite", job.name, result.statistics.non_finite));
    return result;
}

} // namespace gradus::bench
