#include "bench/render/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gradus::bench {

namespace {

struct Difference {
    double largest = 0, relative = 0; // of a pixel's channel; relative to the brighter one
    double visible = 0;               // part of the values that differ by more than 0.1 %
};

Difference difference(const Image &a, const Image &b) {
    Difference d;
    std::size_t values = 0, visible = 0;
    for (const Channel &channel : a.channels) {
        const std::vector<float> &other = b.find(channel.name)->values;
        for (std::size_t i = 0; i < other.size(); ++i, ++values) {
            const double x = channel.values[i], y = other[i], gap = std::abs(x - y);
            d.largest = std::max(d.largest, gap);
            d.relative = std::max(d.relative, gap > 0 ? gap / std::max(std::abs(x), std::abs(y)) : 0.0);
            visible += gap > 1e-3 * std::max(std::abs(x), std::abs(y));
        }
    }
    d.visible = double(visible) / double(values);
    return d;
}

} // namespace

nlohmann::json measure_specialisation(const Settings &settings, const Job &job) {
    RenderOptions everything;
    everything.all_traits = true;
    std::vector<double> kernels, renders;
    Difference d; // the largest of all turns
    for (int i = 0; i < settings.repeats; ++i) {
        const Render own = render(settings, job), all = render(settings, job, everything);
        kernels.push_back(all.kernel_seconds() / own.kernel_seconds());
        renders.push_back(all.seconds() / own.seconds());
        const Difference found = difference(own.image, all.image);
        d = {std::max(d.largest, found.largest), std::max(d.relative, found.relative),
             std::max(d.visible, found.visible)};
    }
    fmt::print(
        "{}\n  every trait on / specialised: kernels {:.2f}, render {:.2f}\n  the images: largest difference {:.3g} "
        "({:.3g} relative), {:.3g} % of the values differ by over 0.1 %\n\n",
        job.name, median(kernels), median(renders), d.largest, d.relative, 100 * d.visible);
    return {{"job", job.name},
            {"kernel_ratio", spread(kernels)},
            {"render_ratio", spread(renders)},
            {"largest_difference", d.largest},
            {"largest_relative_difference", d.relative},
            {"share_that_differs_visibly", d.visible}};
}

} // namespace gradus::bench
