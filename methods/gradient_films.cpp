#include "methods/gradient_films.h"

#include "kernels/shared/tables.h"
#include "runtime/film/replicates.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

double GradientFilm::sum(Layer layer, std::uint32_t color, std::size_t pixel) const {
    const int number = 3 * layer + int(color);
    return table_.real(gradient_film_primal_r + number, pixel) +
           table_.real(gradient_film_correction_first + number, pixel);
}

double GradientFilm::squares(Layer layer, std::uint32_t color, std::size_t pixel) const {
    return table_.real(gradient_film_square_first + 3 * layer + int(color), pixel);
}

std::uint64_t GradientFilms::samples() const {
    std::uint64_t samples = 0;
    for (const auto &film : films_)
        samples += film->samples();
    return samples;
}

GradientFilms GradientFilms::half(int number) const {
    GradientFilms half;
    for (auto part = std::size_t(number); part < films_.size(); part += 2)
        half.films_.push_back(films_[part]);
    return half;
}

PlaneSource GradientFilms::mean(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            double sum = 0, weight = 0;
            for (const auto &film : films_) {
                sum += film->sum(layer, color, pixel);
                weight += film->weight(layer, pixel);
            }
            plane[pixel] = static_cast<float>(weight > 0 ? sum / weight : sum);
        }
    };
}

PlaneSource GradientFilms::variance(GradientFilm::Layer layer) const {
    if (!has_replicates_)
        return variance_of_samples(layer);
    return [this, layer](std::uint32_t color, float *plane) {
        std::vector<Replicate> replicates(films_.size());
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            for (std::size_t part = 0; part < films_.size(); ++part)
                replicates[part] = {films_[part]->sum(layer, color, pixel), films_[part]->weight(layer, pixel)};
            plane[pixel] = static_cast<float>(variance_of_mean(replicates));
        }
    };
}

PlaneSource GradientFilms::variance_of_samples(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        const std::size_t halves = has_halves_ ? 2 : 1;
        for (std::size_t pixel = 0; pixel < pixels(); ++pixel) {
            double count = 0, variance = 0;
            for (const auto &film : films_)
                count += film->count(layer, pixel);
            for (std::size_t half = 0; half < halves; ++half) {
                double n = 0, sum = 0, squares = 0;
                for (std::size_t part = half; part < films_.size(); part += halves) {
                    n += films_[part]->count(layer, pixel);
                    sum += films_[part]->sum(layer, color, pixel);
                    squares += films_[part]->squares(layer, color, pixel);
                }
                const double share = n / std::max(count, 1.0), mean = sum / std::max(n, 1.0);
                variance += n > 1 ? share * share * std::max(0.0, squares / n - mean * mean) / (n - 1) : 0;
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
