#include "runtime/methods/gradient_image.h"

#include "kernels/shared/tables.h"

#include <algorithm>
#include <cmath>

namespace gradus {

using namespace lib_float;

namespace {

const char *const layer_names[] = {"primal", "dx", "dy"}, *const colors[] = {"R", "G", "B"};

/// The three channels of an image, one after the other.
std::vector<float> planes(const std::vector<Channel> &channels, int image) {
    std::vector<float> joined;
    for (int c = 0; c < 3; ++c) {
        const std::vector<float> &values = channels[3 * image + c].values;
        joined.insert(joined.end(), values.begin(), values.end());
    }
    return joined;
}

void add_layer(Image &image, const std::string &prefix, const std::vector<float> &joined) {
    const std::ptrdiff_t pixels = std::ptrdiff_t(image.width) * image.height;
    for (int c = 0; c < 3; ++c)
        image.channels.push_back(
            {prefix + colors[c], {joined.begin() + c * pixels, joined.begin() + (c + 1) * pixels}});
}

} // namespace

GradientLayers read_gradient_film(const HostTable &film, std::size_t pixels, std::uint64_t frames) {
    const double n = double(std::max<std::uint64_t>(frames, 1));
    GradientLayers layers;
    layers.frames = frames;
    for (int number = 0; number < 9; ++number) {
        const std::string layer = layer_names[number / 3], color = colors[number % 3];
        Channel mean{layer + "." + color, std::vector<float>(pixels)};
        Channel variance{layer + "_variance." + color, std::vector<float>(pixels)};
        const auto column = [&](int first, std::size_t pixel) { return film.real(first + number, pixel); };
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            const double value =
                (column(gradient_film_primal_r, pixel) + column(gradient_film_correction_first, pixel)) / n;
            const double square = column(gradient_film_square_first, pixel) / n;
            mean.values[pixel] = static_cast<float>(value);
            variance.values[pixel] = n > 1 ? static_cast<float>(std::max(0.0, square - value * value) / (n - 1)) : 0.0f;
        }
        layers.means.push_back(std::move(mean));
        layers.variances.push_back(std::move(variance));
    }
    return layers;
}

Image reconstruct(PoissonSolver &solver, const Image &whole, const GradientLayers &layers,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options) {
    const std::vector<float> primal = planes(layers.means, 0), dx = planes(layers.means, 1),
                             dy = planes(layers.means, 2);
    const std::vector<float> primal_variance = planes(layers.variances, 0), dx_variance = planes(layers.variances, 1),
                             dy_variance = planes(layers.variances, 2);
    const std::size_t pixels = primal.size() / 3;
    std::vector<float> direct(primal.size());
    for (std::size_t i = 0; i < direct.size(); ++i) {
        const float seen = whole.channels[i / pixels].values[i % pixels] - primal[i];
        // Where no light is seen, the difference is rounding.
        direct[i] = std::abs(seen) > 1e-6f * std::abs(primal[i]) ? seen : 0.0f;
    }
    for (const DirectPixel &edge : edges)
        for (std::size_t c = 0; c < 3; ++c)
            direct[c * pixels + edge.pixel] = edge.light[c];
    HostImages images;
    images.primal = primal.data();
    images.dx = dx.data();
    images.dy = dy.data();
    images.direct = direct.data();
    images.primal_variance = primal_variance.data();
    images.dx_variance = dx_variance.data();
    images.dy_variance = dy_variance.data();
    PoissonOptions poisson;
    poisson.norm = options.norm;
    poisson.alpha_from_variances = !options.alpha && layers.frames > 1;
    poisson.alpha = options.alpha.value_or(poisson.alpha);
    std::vector<float> result(primal.size());
    solver.solve(images, poisson, result.data());

    Image image;
    image.width = whole.width;
    image.height = whole.height;
    add_layer(image, "", result);
    add_layer(image, "direct.", direct);
    image.channels.insert(image.channels.end(), layers.means.begin(), layers.means.end());
    if (options.aov)
        image.channels.insert(image.channels.end(), layers.variances.begin(), layers.variances.end());
    image.channels.insert(image.channels.end(), whole.channels.begin() + 3, whole.channels.end());
    return image;
}

} // namespace gradus
