#include "bench/render/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace gradus::bench {

nlohmann::json measure_ray_order(const Settings &settings, const Job &job) {
    const std::vector<std::pair<std::string, RayOrder>> orders = {
        {"none", RayOrder::none}, {"octant", RayOrder::octant}, {"cell", RayOrder::cell}};
    std::map<std::string, std::vector<double>> seconds, trace, against_none;
    for (int i = 0; i < settings.repeats; ++i) {
        for (const auto &[name, order] : orders) {
            const Render r = render(settings, job, {},
                                    [order = order](Method &method) { method.tracer()->set_order(order, order); });
            seconds[name].push_back(r.seconds());
            trace[name].push_back(r.stage_seconds("trace"));
            against_none[name].push_back(seconds["none"][std::size_t(i)] / r.seconds());
        }
        const Render standard = render(settings, job);
        seconds["default"].push_back(standard.seconds());
        trace["default"].push_back(standard.stage_seconds("trace"));
        against_none["default"].push_back(seconds["none"][std::size_t(i)] / standard.seconds());
    }
    fmt::print("{}\n  rays in order, speed of the render against none:", job.name);
    nlohmann::json result = {{"job", job.name}};
    for (const std::string name : {"octant", "cell", "default"})
        fmt::print(" {} {:.3f} (trace {:.2f})", name, median(against_none[name]),
                   median(trace["none"]) / median(trace[name]));
    fmt::print("\n\n");
    for (const auto &[name, values] : seconds)
        result[name] = {{"render_seconds", spread(values)},
                        {"trace_seconds", spread(trace[name])},
                        {"speed_against_none", spread(against_none[name])}};
    return result;
}

} // namespace gradus::bench
