#include "methods/gradient_films.h"

#include "kernels/shared/tables.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

double GradientFilm::sum(Layer layer, std::uint32_t color, std::size_t pixel) const {
    const int number = 3 * layer + int(color);
    return table_.real(gradient_film_primal_r + number, pixel) +
           table_.real(gradient_film_correction_first + number, pixel);
}

double GradientFilm::variance(Layer layer, std::uint32_t color, std::size_t pixel) const {
    const double n = std::max(count(layer, pixel), 1.0);
    const double mean = sum(layer, color, pixel) / n;
    const double square = table_.real(gradient_film_square_first + 3 * layer + int(color), pixel) / n;
    return n > 1 ? std::max(0.0, square - mean * mean) / (n - 1) : 0;
}

std::uint64_t GradientFilms::samples() const {
    std::uint64_t samples = 0;
    for (const auto &film : films_)
        samples += film->samples();
    return samples;
}

GradientFilms GradientFilms::half(int number) const {
    GradientFilms half;
    half.films_.push_back(films_.at(number));
    return half;
}

PlaneSource GradientFilms::mean(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            double sum = 0, count = 0;
            for (const auto &film : films_) {
                sum += film->sum(layer, color, pixel);
                count += film->count(layer, pixel);
            }
            plane[pixel] = static_cast<float>(sum / std::max(count, 1.0));
        }
    };
}

PlaneSource GradientFilms::variance(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            double count = 0, variance = 0;
            for (const auto &film : films_)
                count += film->count(layer, pixel);
            for (const auto &film : films_) {
                const double share = film->count(layer, pixel) / std::max(count, 1.0);
                variance += share * share * film->variance(layer, color, pixel);
            }
            plane[pixel] = static_cast<float>(variance);
        }
    };
}

ImageSources GradientFilms::images() const {
    ImageSources images;
    images.primal = mean(GradientFilm::primal);
    images.dx = mean(GradientFilm::dx);
    images.dy = mean(GradientFilm::dy);
    images.primal_variance = variance(GradientFilm::primal);
    images.dx_variance = variance(GradientFilm::dx);
    images.dy_variance = variance(GradientFilm::dy);
    return images;
}

} // namespace gradus
