#include "planning/pilot.h"

#include "runtime/film/metrics.h"
#include "runtime/film/outliers.h"
#include "runtime/wavefront/sample_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace gradus {

namespace {

/// Of the film's 64-bit sample numbers. The upper word decides where the sequence of places within the pixel starts,
/// and halves differ in it: also once replicates have taken their bits off (kernels/lib/sample_number.h), or the places
/// of the one would be those of the other, all as far away.
constexpr std::uint64_t first_samples[] = {std::uint64_t(1) << 62,
                                           (std::uint64_t(1) << 62) + (std::uint64_t(1) << (32 + replicate_bits))};
static_assert(first_samples[0] >> replicate_bits >> 32 != first_samples[1] >> replicate_bits >> 32);
constexpr std::uint64_t largest_part = 10; ///< one in so many samples of the render

} // namespace

std::vector<double> relative_weights(const ReferencePairs &references, const char *color) {
    std::vector<double> least;
    for (const auto &[first, second] : references) {
        const std::vector<float> &a = first->find(color)->values, &b = second->find(color)->values;
        std::vector<double> means(a.size());
        for (std::size_t i = 0; i < a.size(); ++i)
            means[i] = 0.5 * (double(a[i]) + b[i]);
        const std::vector<double> of_pair = relative_weights(std::move(means), first->width, first->height);
        least.resize(a.size(), std::numeric_limits<double>::infinity());
        for (std::size_t i = 0; i < a.size(); ++i)
            least[i] = std::min(least[i], of_pair[i]);
    }
    return least;
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

bool has_room_for_halves(std::uint64_t samples_per_pixel) {
    return samples_per_pixel >= largest_part * 2 * half_samples;
}

Pilot run_pilot(GradientPathTracer &method) {
    Pilot pilot;
    for (int half = 0; half < 2; ++half) {
        method.restart(first_samples[half], half_samples);
        while (method.render_batch()) {
        }
        pilot.halves[half] = method.image_with_layers();
        pilot.seconds += method.statistics().render_seconds;
    }
    return pilot;
}

} // namespace gradus
