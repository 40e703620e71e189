#include "runtime/scene/light_table.h"

#include <map>

namespace gradus {

AliasTable make_alias_table(const std::vector<double> &weights) {
    const std::size_t count = weights.size();
    double total = 0;
    for (double weight : weights)
        total += weight;
    AliasTable table;
    table.probability.resize(count);
    table.threshold.assign(count, 1.0f);
    table.alias.resize(count);
    std::vector<double> scaled(count);
    std::vector<std::uint32_t> small, large;
    for (std::size_t i = 0; i < count; ++i) {
        table.probability[i] = static_cast<float>(weights[i] / total);
        table.alias[i] = static_cast<std::uint32_t>(i);
        scaled[i] = weights[i] / total * static_cast<double>(count);
        (scaled[i] < 1 ? small : large).push_back(static_cast<std::uint32_t>(i));
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t low = small.back(), high = large.back();
        small.pop_back();
        table.threshold[low] = static_cast<float>(scaled[low]);
        table.alias[low] = high;
        scaled[high] -= 1 - scaled[low];
        if (scaled[high] < 1) {
            large.pop_back();
            small.push_back(high);
        }
    }
    return table; // what is left over is 1 but for rounding
}

std::vector<double> light_weights(const std::vector<LightPower> &lights) {
    std::map<std::uint32_t, double> emitters; // power of each
    double finite_power = 0;
    std::size_t at_infinity = 0;
    for (const LightPower &light : lights) {
        emitters[light.emitter] += light.power;
        if (light.at_infinity)
            ++at_infinity; // each is an emitter of its own
        else
            finite_power += light.power;
    }
    const std::size_t finite_emitters = emitters.size() - at_infinity;
    if (finite_emitters > 0)
        for (const LightPower &light : lights)
            if (light.at_infinity)
                emitters[light.emitter] = finite_power / static_cast<double>(finite_emitters);
    double total = 0;
    for (const auto &[emitter, power] : emitters)
        total += power;
    std::vector<double> weights;
    for (const LightPower &light : lights) {
        const double power = emitters[light.emitter];
        const double part = light.at_infinity ? 1 : light.power / power;
        weights.push_back(part * (0.5 * power / total + 0.5 / static_cast<double>(emitters.size())));
    }
    return weights;
}

} // namespace gradus
