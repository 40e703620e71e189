#include "bench/render/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace gradus::bench {

namespace {

/// Enough recorded calls of the tracer to stand for all, few enough to fit into memory.
constexpr std::size_t recorded_calls = 40;

/// Of a render's time over the replay's.
double target_of(const std::string &method) { return method == "pt" ? 1.5 : 1.6; }

/// A prime near the quotient, so that the recorded calls meet all depths of a path in turn.
std::size_t record_interval(std::size_t calls) {
    const std::size_t aim = std::max<std::size_t>(calls / recorded_calls, 1);
    for (const std::size_t prime : {997u, 499u, 251u, 127u, 61u, 31u, 17u, 7u, 5u, 3u, 2u})
        if (prime <= aim)
            return prime;
    return 1;
}

/// Seconds a ray, the median of three passes: one is short.
double seconds_per_ray(Tracer &tracer, ReplayedAs as) {
    std::vector<double> seconds;
    for (int pass = 0; pass < 3; ++pass) {
        const Replayed replayed = tracer.replay(as);
        seconds.push_back(replayed.seconds / double(replayed.rays));
    }
    return median(seconds);
}

/// One row of the profile as a share of the render. The tracer's row is split in two: Embree, as the replay says, and
/// the rest of the tracer (sorting, packing, unpacking).
struct Row {
    std::string name;
    double share;
};

std::vector<Row> profile(const Render &render, double floor_seconds) {
    std::vector<Row> rows;
    for (const StageTime &stage : render.statistics.stages)
        if (stage.name == "trace") {
            rows.push_back({"Embree (replay)", floor_seconds / render.seconds()});
            rows.push_back({"trace beside Embree", (stage.seconds - floor_seconds) / render.seconds()});
        } else {
            rows.push_back({stage.name, stage.seconds / render.seconds()});
        }
    return rows;
}

} // namespace

nlohmann::json measure_floor(const Settings &settings, const Job &job) {
    RenderOptions options;
    options.threads = settings.threads;
    // One render is recorded and kept; its time does not count, as recording costs time.
    const std::unique_ptr<Method> recorder = method_of(settings, job, options);
    const std::uint64_t batches = (recorder->total_samples() + (1u << 16) - 1) >> 16;
    const int depth = job.scene.settings.max_depth < 0 ? 16 : job.scene.settings.max_depth;
    recorder->tracer()->record(record_interval(batches * static_cast<std::uint64_t>(depth)));
    while (recorder->render_batch()) {
    }

    std::vector<double> ratios, render_rates, replay_rates, seconds;
    std::vector<Render> renders;
    std::vector<double> floors;
    std::map<std::string, std::vector<double>> other_ratios, other_rates;
    Tracer &tracer = *recorder->tracer();
    const std::uint64_t recorded = tracer.replay(ReplayedAs::traced).rays;
    for (int i = 0; i < settings.repeats; ++i) {
        const double before = seconds_per_ray(tracer, ReplayedAs::traced);
        renders.push_back(render(settings, job));
        const double after = seconds_per_ray(tracer, ReplayedAs::traced);
        const Render &r = renders.back();
        const double per_ray = 0.5 * (before + after);
        floors.push_back(per_ray * double(r.rays()));
        ratios.push_back(r.seconds() / floors.back());
        seconds.push_back(r.seconds());
        render_rates.push_back(double(r.rays()) / r.seconds() / 1e6);
        replay_rates.push_back(1e-6 / per_ray);
        for (const auto &[name, as] : {std::pair("packets", ReplayedAs::packets), {"single", ReplayedAs::single}}) {
            const double other = seconds_per_ray(tracer, as);
            other_ratios[name].push_back(r.seconds() / (other * double(r.rays())));
            other_rates[name].push_back(1e-6 / other);
        }
    }
    // The profile of the render of the median ratio.
    std::vector<std::size_t> order(ratios.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return ratios[a] < ratios[b]; });
    const std::size_t middle = order[order.size() / 2];
    std::vector<Row> rows = profile(renders[middle], floors[middle]);

    const Render &r = renders[middle];
    const double target = target_of(settings.method);
    fmt::print("{}, {}\n  render / Embree-only replay of the same rays: {:.2f} (target {}{})\n", job.name,
               settings.method, median(ratios), target, settings.method == "pt" ? ", aim 1.2" : "");
    fmt::print("  {:.1f} M rays/s against {:.1f} M rays/s; {:.2f} M samples/s, {:.2f} rays a sample, "
               "{:.3g} M of {:.3g} M rays recorded\n",
               median(render_rates), median(replay_rates), double(r.statistics.samples) / r.seconds() / 1e6,
               double(r.rays()) / double(r.statistics.samples), double(recorded) / 1e6, double(r.rays()) / 1e6);
    fmt::print("  over a replay in packets of 16 that are no beams: {:.2f} ({:.1f} M rays/s); ray by ray: {:.2f} "
               "({:.1f} M rays/s)\n",
               median(other_ratios["packets"]), median(other_rates["packets"]), median(other_ratios["single"]),
               median(other_rates["single"]));
    nlohmann::json others;
    for (const auto &[name, values] : other_ratios)
        others[name] = {{"ratio", spread(values)}, {"replay_mrays_per_second", spread(other_rates[name])}};
    nlohmann::json stages = nlohmann::json::array();
    for (const Row &row : rows) {
        fmt::print("  {:32} {:6.1f} %\n", row.name, 100 * row.share);
        stages.push_back({{"name", row.name}, {"share", row.share}});
    }
    std::sort(rows.begin(), rows.end(), [](const Row &a, const Row &b) { return a.share > b.share; });
    std::erase_if(rows, [](const Row &row) { return row.name.starts_with("Embree"); });
    fmt::print("  the difference is mostly {} ({:.1f} %), {} ({:.1f} %) and {} ({:.1f} %)\n\n", rows[0].name,
               100 * rows[0].share, rows[1].name, 100 * rows[1].share, rows[2].name, 100 * rows[2].share);
    return {{"job", job.name},
            {"method", settings.method},
            {"ratio", spread(ratios)},
            {"target", target},
            {"render_seconds", spread(seconds)},
            {"render_mrays_per_second", spread(render_rates)},
            {"replay_mrays_per_second", spread(replay_rates)},
            {"samples", r.statistics.samples},
            {"rays", r.statistics.rays},
            {"recorded_rays", recorded},
            {"other_replays", others},
            {"profile", stages}};
}

} // namespace gradus::bench
