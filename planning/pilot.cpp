#include "planning/pilot.h"

#include "runtime/film/metrics.h"
#include "runtime/film/outliers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace gradus {

namespace {

/// Of the film's 64-bit sample numbers; halves differ in the upper word too, which decides where the sequence of
/// places within the pixel starts.
constexpr std::uint64_t first_samples[] = {std::uint64_t(1) << 62, (std::uint64_t(1) << 62) + (std::uint64_t(1) << 32)};
/// Of a half. Fewer make gpt look worse than it is: all its pixels share their place within the pixel, and edges are as
/// jagged as those places are few. Times its samples, its relMSE was 1.1 to 1.3 times that of 64 samples where gains
/// are small (tests/references: holes, materials, torus), with 2 samples 1.2 to 2.1 times, with 1 up to 3.3 times.
constexpr std::uint64_t half_samples = pilot_samples / 2;
/// What is left of that: relMSE of gpt over that of pt with so few samples, over the same with many. Measured 1.1
/// to 1.4 where gains are small, the samples of pt being a little better for gpt's even places.
constexpr double excess_of_few_places = 1.25;
constexpr std::uint64_t largest_part = 10; ///< one in so many samples of the render

/// What a ray of an offset path costs, its shift and shading counted in, over one of the base path. From the measured
/// times of bench/render/gradient.py: 1.2 to 1.7 by scene.
constexpr double offset_ray_cost = 1.5;

} // namespace

std::vector<double> relative_weights(const ReferencePairs &references, const char *color) {
    std::vector<double> largest, means;
    for (const auto &[first, second] : references) {
        const std::vector<float> &a = first->find(color)->values, &b = second->find(color)->values;
        means.resize(a.size());
        largest.resize(a.size(), 0.0);
        for (std::size_t i = 0; i < a.size(); ++i)
            means[i] = 0.5 * (double(a[i]) + b[i]);
        const std::vector<double> usual = without_outliers(means, first->width, first->height);
        for (std::size_t i = 0; i < a.size(); ++i)
            largest[i] = std::max(largest[i], std::fabs(usual[i]));
    }
    for (double &value : largest)
        value = 1 / (value * value + relative_mse_epsilon);
    return largest;
}

PilotErrors estimate_errors(const Image &first, const Image &second) {
    return estimate_errors(first, second, {{&first, &second}});
}

PilotErrors estimate_errors(const Image &first, const Image &second, const ReferencePairs &references) {
    double pt = 0, gpt_variance = 0, gpt_bias = 0;
    std::size_t count = 0;
    for (const char *color : {"R", "G", "B"}) {
        const auto channel = [color](const Image &image, const char *layer) {
            return image.find(fmt::format("{}{}", layer, color))->values.data();
        };
        const float *r_1 = channel(first, ""), *r_2 = channel(second, "");
        const float *primal_1 = channel(first, "primal."), *primal_2 = channel(second, "primal.");
        const float *direct_1 = channel(first, "direct."), *direct_2 = channel(second, "direct.");
        const std::size_t pixels = first.find(color)->values.size();
        const std::vector<double> weights = relative_weights(references, color);
        for (std::size_t i = 0; i < pixels; ++i) {
            const double w_1 = double(primal_1[i]) + direct_1[i], w_2 = double(primal_2[i]) + direct_2[i];
            const double weight = weights[i];
            const double spread = double(r_1[i]) - r_2[i];
            pt += 0.5 * weight * (w_1 - w_2) * (w_1 - w_2);
            gpt_variance += 0.5 * weight * spread * spread;
            gpt_bias += weight * (r_1[i] - w_1) * (r_2[i] - w_2);
        }
        count += pixels;
    }
    // A square is not negative, and its estimate may be.
    return {pt / double(count), (gpt_variance + std::max(gpt_bias, 0.0)) / double(count)};
}

bool has_room_for_pilot(std::uint64_t samples_per_pixel) { return samples_per_pixel >= largest_part * pilot_samples; }

Pilot run_pilot(GradientPathTracer &method) {
    Pilot pilot;
    std::array<Image, 2> &halves = pilot.halves;
    std::map<std::string, double> rays;
    double samples = 0;
    for (int half = 0; half < 2; ++half) {
        method.restart(first_samples[half], half_samples);
        while (method.render_batch()) {
        }
        halves[half] = method.image_with_layers();
        const Statistics statistics = method.statistics();
        for (const auto &[kind, count] : statistics.rays)
            rays[kind] += double(count);
        samples += double(statistics.samples);
        pilot.seconds += statistics.render_seconds;
    }
    pilot.errors = estimate_errors(halves[0], halves[1]);
    pilot.errors.gpt /= excess_of_few_places;
    pilot.costs.pt = (rays["extension"] + rays["shadow"]) / samples;
    pilot.costs.gpt = pilot.costs.pt + offset_ray_cost * rays["offset"] / samples;
    return pilot;
}

} // namespace gradus
