#include "methods/photons/light_paths.h"
#include "bench/render/measurements.h"
#include "methods/path_stages.h"
#include "runtime/error.h"
#include "runtime/seconds_since.h"

#include <fmt/format.h>

#include <chrono>

namespace gradus::bench {

namespace {

/// Every so many calls of the tracer are recorded: a prime, so that all depths of a path come in turn.
constexpr std::size_t every_third = 3;

/// Light paths without a method that gathers their photons.
struct Tracing {
    Tracing(const Settings &settings, const Job &job, const RenderOptions &options)
        : session(settings.device, job.scene, options, {}),
          paths(session, stages, job.scene, options, LightPaths::Direct::photons),
          tables(settings.device, paths.tables(), {}, options.precision) {
        paths.attach(tables);
    }
    Session session;
    Stages stages;
    LightPaths paths;
    Tables tables;
};

} // namespace

nlohmann::json measure_light_paths(const Settings &settings, const Job &job) {
    RenderOptions options;
    options.threads = settings.threads;
    // The rays of one are recorded, which costs time; the other one is timed.
    Tracing recorder(settings, job, options), tracing(settings, job, options);
    const std::uint32_t count = tracing.paths.paths_a_pass();
    recorder.session.tracer.record(every_third);
    recorder.paths.trace(0, count);
    if (count == 0 || recorder.paths.rays() == 0 || recorder.session.tracer.replay(ReplayedAs::traced).rays == 0)
        throw Error(ExitCode::failure, fmt::format("{}: no light path has a ray that could be timed", job.name));
    std::uint64_t first = 0;
    const auto trace = [&] {
        const auto start = std::chrono::steady_clock::now();
        tracing.paths.trace(first, count);
        finish(settings.device);
        first += count;
        return seconds_since(start);
    };
    trace(); // tables have grown as they must

    std::vector<double> ratios, rates, photon_rates;
    const std::uint64_t photons = tracing.paths.photons(), rays = tracing.paths.rays();
    const std::vector<StageTime> before = tracing.paths.times();
    for (int i = 0; i < settings.repeats; ++i) {
        const std::uint64_t photons_before = tracing.paths.photons(), rays_before = tracing.paths.rays();
        const double seconds = trace();
        const Replayed replayed = recorder.session.tracer.replay(ReplayedAs::traced);
        const double traced = double(tracing.paths.rays() - rays_before);
        ratios.push_back(seconds / (replayed.seconds / double(replayed.rays) * traced));
        rates.push_back(count / seconds / 1e6);
        photon_rates.push_back(double(tracing.paths.photons() - photons_before) / seconds / 1e6);
    }
    const double turns = settings.repeats, paths = double(count) * turns;
    fmt::print("{}\n  {:.2f} M light paths/s, {:.2f} M photons/s; time over Embree alone on the same rays: {:.2f}\n",
               job.name, median(rates), median(photon_rates), median(ratios));
    fmt::print("  {} light paths a pass, {:.2f} photons and {:.2f} rays each\n", count,
               double(tracing.paths.photons() - photons) / paths, double(tracing.paths.rays() - rays) / paths);
    const std::vector<StageTime> after = tracing.paths.times();
    for (std::size_t i = 0; i < after.size(); ++i) {
        const double seconds = after[i].seconds - before[i].seconds, items = double(after[i].items - before[i].items);
        if (items > 0) // work-items: where a stage goes by chunks of rows, an item is a chunk
            fmt::print("  {:36} {:7.2f} ms a pass, {:6.2f} ns an item\n", after[i].name, 1e3 * seconds / turns,
                       1e9 * seconds / items);
    }
    return {{"job", job.name},
            {"light_paths", count},
            {"mlight_paths_per_second", spread(rates)},
            {"mphotons_per_second", spread(photon_rates)},
            {"ratio", spread(ratios)}};
}

} // namespace gradus::bench
