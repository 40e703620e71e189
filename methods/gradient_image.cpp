#include "methods/gradient_image.h"

#include "kernels/shared/tables.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

const char *const layer_names[] = {"primal", "dx", "dy"}, *const colors[] = {"R", "G", "B"};

/// Makes of the channels of `whole` what they have and the primal has not.
void take_primal_off(Image &whole, const GradientFilm &film, const std::vector<DirectPixel> &edges) {
    std::vector<float> primal(film.pixels());
    for (std::uint32_t c = 0; c < 3; ++c) {
        std::vector<float> &direct = whole.channels[c].values;
        film.mean(GradientFilm::primal, c, primal.data());
        for (std::size_t i = 0; i < direct.size(); ++i) {
            const float seen = direct[i] - primal[i];
            // Where no light is seen, the difference is rounding.
            direct[i] = std::abs(seen) > 1e-6f * std::abs(primal[i]) ? seen : 0.0f;
        }
        for (const DirectPixel &edge : edges)
            direct[edge.pixel] = edge.light[c];
    }
}

/// What `gradus solve` needs to make the image again: from the channels `direct` of an image, and from the film.
std::vector<Channel> layers_of(const Image &direct, const GradientFilm &film, bool variances) {
    std::vector<Channel> layers;
    for (std::uint32_t c = 0; c < 3; ++c)
        layers.push_back({std::string("direct.") + colors[c], direct.channels[c].values});
    for (const bool variance : {false, true})
        for (const auto layer : {GradientFilm::primal, GradientFilm::dx, GradientFilm::dy})
            for (std::uint32_t c = 0; c < 3 && (variances || !variance); ++c) {
                Channel channel{std::string(layer_names[layer]) + (variance ? "_variance." : ".") + colors[c],
                                std::vector<float>(film.pixels())};
                if (variance)
                    film.variance(layer, c, channel.values.data());
                else
                    film.mean(layer, c, channel.values.data());
                layers.push_back(std::move(channel));
            }
    return layers;
}

} // namespace

double GradientFilm::mean_at(int number, std::size_t pixel, double frames) const {
    return (table_.real(gradient_film_primal_r + number, pixel) +
            table_.real(gradient_film_correction_first + number, pixel)) /
           frames;
}

void GradientFilm::mean(Layer layer, std::uint32_t color, float *plane) const {
    for (std::size_t pixel = 0; pixel < pixels_; ++pixel)
        plane[pixel] =
            static_cast<float>(mean_at(3 * layer + int(color), pixel, std::max(count_at(layer, pixel), 1.0)));
}

void GradientFilm::variance(Layer layer, std::uint32_t color, float *plane) const {
    const int number = 3 * layer + int(color);
    for (std::size_t pixel = 0; pixel < pixels_; ++pixel) {
        const double n = std::max(count_at(layer, pixel), 1.0);
        const double value = mean_at(number, pixel, n);
        const double square = table_.real(gradient_film_square_first + number, pixel) / n;
        plane[pixel] = n > 1 ? static_cast<float>(std::max(0.0, square - value * value) / (n - 1)) : 0.0f;
    }
}

PoissonOptions poisson_options(const RenderOptions &options, std::uint64_t frames) {
    PoissonOptions poisson;
    poisson.norm = options.norm;
    poisson.alpha_from_variances = !options.alpha && frames > 1;
    poisson.alpha = options.alpha.value_or(poisson.alpha);
    return poisson;
}

Image reconstruct(PoissonSolver &solver, Image whole, std::unique_ptr<const GradientFilm> film,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options, bool layers,
                  const std::function<void()> &film_is_read) {
    const PoissonOptions poisson = poisson_options(options, film->frames());
    take_primal_off(whole, *film, edges);
    std::vector<Channel> more;
    if (layers)
        more = layers_of(whole, *film, options.aov);

    const auto mean = [&film](GradientFilm::Layer layer) {
        return [&film, layer](std::uint32_t c, float *plane) { film->mean(layer, c, plane); };
    };
    const auto variance = [&film](GradientFilm::Layer layer) {
        return [&film, layer](std::uint32_t c, float *plane) { film->variance(layer, c, plane); };
    };
    ImageSources images;
    images.primal = mean(GradientFilm::primal);
    images.dx = mean(GradientFilm::dx);
    images.dy = mean(GradientFilm::dy);
    images.primal_variance = variance(GradientFilm::primal);
    images.dx_variance = variance(GradientFilm::dx);
    images.dy_variance = variance(GradientFilm::dy);
    // The result takes the place of the direct image.
    const auto plane_of = [&whole](std::uint32_t c) { return whole.channels[c].values.data(); };
    const std::size_t pixels = film->pixels();
    images.direct = [&](std::uint32_t c, float *plane) { std::copy_n(plane_of(c), pixels, plane); };
    solver.solve(
        images, poisson, [&](std::uint32_t c, const float *plane) { std::copy_n(plane, pixels, plane_of(c)); },
        [&] {
            film.reset();
            if (film_is_read)
                film_is_read();
        });
    whole.channels.insert(whole.channels.begin() + 3, std::make_move_iterator(more.begin()),
                          std::make_move_iterator(more.end()));
    return whole;
}

} // namespace gradus
