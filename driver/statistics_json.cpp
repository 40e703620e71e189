#include "driver/statistics_json.h"

#include "driver/program.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <sys/resource.h>

namespace gradus {

std::uint64_t peak_memory_bytes() {
    struct rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024; // Linux counts in KiB
}

nlohmann::json device_json(const DeviceDescription &device) {
    return {{"name", device.name},
            {"platform", device.platform},
            {"version", device.version},
            {"driver", device.driver},
            {"type", device.type}};
}

nlohmann::json choice_json(const MethodChoice &choice) {
    using nlohmann::json;
    json estimates = json::object();
    for (const auto &[method, estimate] : choice.estimates)
        estimates[method] = {{"relative_mse", estimate.relative_mse}, {"cost", estimate.cost}};
    return {{"method", choice.method},
            {"reason", choice.reason},
            {"pilot", {{"spp", choice.pilot_samples}, {"seconds", choice.pilot_seconds}}},
            {"estimates", estimates},
            {"gain", choice.gain > 0 ? json(choice.gain) : json()}};
}

static nlohmann::json number_or_null(const std::optional<double> &number) {
    return number ? nlohmann::json(*number) : nlohmann::json();
}

nlohmann::json reconstruction_json(const ReconstructionUsed &used) {
    return {{"name", used.name},
            {"guide", used.guide},
            {"alpha", number_or_null(used.alpha)},
            {"accuracy", used.accuracy},
            {"note", used.note}};
}

nlohmann::json gathering_json(const Statistics &statistics) {
    const double points = double(statistics.gather_points);
    const auto mean_radius = [](const GatherRadii &radii) {
        return radii.points > 0 ? radii.sum / double(radii.points) : 0.0;
    };
    const auto by_point = [points](double sum) { return points > 0 ? sum / points : 0.0; };
    return {{"gather_points", statistics.gather_points},
            {"pairs", statistics.photon_pairs},
            {"photons_a_gather_point", by_point(double(statistics.photon_pairs))},
            {"mean_radius", by_point(statistics.radius_sum)},
            {"mean_radius_of_first_pass", mean_radius(statistics.first_radii)},
            {"mean_radius_of_last_pass", mean_radius(statistics.last_radii)},
            {"relative_variance", number_or_null(statistics.relative_variance)},
            {"relative_squared_bias", number_or_null(statistics.relative_squared_bias)},
            {"gathered_at", statistics.surfaces.gathered},
            {"passed_at", statistics.surfaces.passed}};
}

nlohmann::json statistics_to_json(const RenderRecord &record, const Statistics &statistics) {
    using nlohmann::json;
    const double seconds = statistics.render_seconds;
    const auto rate = [seconds](double count) { return seconds > 0 ? count / seconds : 0.0; };

    json stages = json::array();
    for (const StageTime &stage : statistics.stages)
        stages.push_back({{"name", stage.name},
                          {"seconds", stage.seconds},
                          {"share", seconds > 0 ? stage.seconds / seconds : 0.0},
                          {"items", stage.items},
                          {"launches", stage.launches}});
    json rays = json::object();
    std::uint64_t ray_count = 0;
    for (const auto &[kind, count] : statistics.rays) {
        rays[kind] = {{"count", count}, {"per_second", rate(double(count))}};
        ray_count += count;
    }
    double compile_total = 0;
    for (const auto &[kernel, kernel_seconds] : statistics.compile_seconds)
        compile_total += kernel_seconds;

    json phases = json::object();
    for (const auto &[phase, phase_seconds] : record.phase_seconds)
        phases[phase] = phase_seconds;

    json result = {{"version", version()},
                   {"scene", record.scene},
                   {"method", record.method},
                   {"precision", record.precision},
                   {"sampler", record.sampler},
                   {"device", device_json(record.device)},
                   {"seed", record.seed},
                   {"width", record.width},
                   {"height", record.height},
                   {"spp", record.samples_per_pixel},
                   {"reconstruction", reconstruction_json(statistics.reconstruction)},
                   {"interrupted", record.interrupted},
                   {"stopped_by", record.stopped_by},
                   {"estimated_error", number_or_null(statistics.estimated_error)},
                   {"samples", statistics.samples},
                   {"samples_per_second", rate(double(statistics.samples))},
                   {"stages", stages},
                   {"rays", rays},
                   {"rays_per_second", rate(double(ray_count))},
                   {"non_finite", statistics.non_finite},
                   {"compile_seconds", {{"total", compile_total}, {"kernels", statistics.compile_seconds}}},
                   {"memory",
                    {{"peak_host_bytes", std::max(statistics.peak_host_bytes, peak_memory_bytes())},
                     {"device_bytes", statistics.device_bytes}}},
                   {"phase_seconds", phases},
                   {"prepare_seconds", record.prepare_seconds},
                   {"render_seconds", seconds},
                   {"wall_seconds", record.wall_seconds}};
    // Each where its method is.
    if (!statistics.surfaces.gathered.empty()) {
        result["light_paths"] = statistics.light_paths;
        result["photons"] = statistics.photons;
        result["gathering"] = gathering_json(statistics);
    }
    if (!statistics.shifts.empty())
        result["shifts"] = statistics.shifts;
    if (!statistics.walks.empty())
        result["walks"] = statistics.walks;
    if (statistics.choice)
        result["choice"] = choice_json(*statistics.choice);
    return result;
}

} // namespace gradus
