#include "methods/gradient_films.h"

#include "kernels/shared/tables.h"
#include "runtime/film/replicates.h"

#include <algorithm>
#include <array>
#include <limits>

namespace gradus {

using namespace lib_float;

namespace {
using Values = std::array<double, GradientFilm::most_at_once>;
}

double GradientFilm::sum(Layer layer, std::uint32_t color, std::size_t pixel) const {
    const int number = 3 * layer + int(color);
    return table_.real(gradient_film_primal_r + number, pixel) +
           table_.real(gradient_film_correction_first + number, pixel);
}

void GradientFilm::add_sums(Layer layer, std::uint32_t color, std::size_t first, std::size_t end, double *to) const {
    const int number = 3 * layer + int(color);
    Values sums{};
    table_.add_reals(gradient_film_primal_r + number, first, end, sums.data());
    table_.add_reals(gradient_film_correction_first + number, first, end, sums.data());
    for (std::size_t i = 0; i < end - first; ++i)
        to[i] += sums[i];
}

void GradientFilm::add_deviations(Layer layer, std::uint32_t color, std::size_t first, std::size_t end,
                                  double *to) const {
    table_.add_reals(gradient_film_deviation_first + 3 * layer + int(color), first, end, to);
}

std::uint64_t GradientFilms::samples() const {
    std::uint64_t samples = 0;
    for (const auto &film : films_)
        samples += film->samples();
    return samples;
}

GradientFilms GradientFilms::half(int number) const {
    GradientFilms half(*tracer_);
    for (auto part = std::size_t(number); part < films_.size(); part += 2)
        half.films_.push_back(films_[part]);
    return half;
}

void GradientFilms::for_each_block(GradientFilm::Layer layer,
                                   const std::function<void(std::size_t, std::size_t)> &work) const {
    tracer_->in_parallel(pixels(), [&](std::size_t begin, std::size_t last) {
        for (std::size_t first = begin, end; first < last; first = end) {
            end = std::min(first + GradientFilm::most_at_once, last);
            for (const auto &film : films_)
                end = std::min(end, film->end_of_count(layer, first));
            work(first, end);
        }
    });
}

PlaneSource GradientFilms::mean(GradientFilm::Layer layer, float of_none) const {
    return [this, layer, of_none](std::uint32_t color, float *plane) {
        for_each_block(layer, [&](std::size_t first, std::size_t end) {
            Values sums{};
            double weight = 0;
            for (const auto &film : films_) {
                film->add_sums(layer, color, first, end, sums.data());
                weight += film->weight(layer, first).of_mean;
            }
            for (std::size_t i = 0; i < end - first; ++i)
                plane[first + i] = weight > 0 ? static_cast<float>(sums[i] / weight) : of_none;
        });
    };
}

PlaneSource GradientFilms::variance(GradientFilm::Layer layer) const {
    if (!has_replicates_)
        return variance_of_samples(layer);
    return [this, layer](std::uint32_t color, float *plane) {
        for_each_block(layer, [&](std::size_t first, std::size_t end) {
            std::vector<Replicate> replicates(films_.size());
            for (std::size_t pixel = first; pixel < end; ++pixel) {
                for (std::size_t part = 0; part < films_.size(); ++part)
                    replicates[part] = {films_[part]->sum(layer, color, pixel),
                                        films_[part]->weight(layer, pixel).of_mean};
                plane[pixel] = static_cast<float>(variance_of_mean(replicates));
            }
        });
    };
}

PlaneSource GradientFilms::variance_of_samples(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        for_each_block(layer, [&](std::size_t first, std::size_t end) {
            const std::size_t pixels = end - first;
            double count = 0, weight = 0;
            for (const auto &film : films_) {
                count += film->count(layer, first);
                weight += film->weight(layer, first).of_mean;
            }
            // A half of one sample tells no variance, while samples of both halves are independent of each other.
            const std::size_t halves = has_halves_ && count >= 4 ? 2 : 1;
            Values variance{};
            for (std::size_t half = 0; half < halves; ++half) {
                SampleWeights of_half;
                Values sum{}, deviations{};
                for (std::size_t part = half; part < films_.size(); part += halves) {
                    const GradientFilm &film = *films_[part];
                    if (film.count(layer, first) == 0)
                        continue;
                    const SampleWeights &of_part = film.weight(layer, first);
                    Values sum_of_part{};
                    film.add_sums(layer, color, first, end, sum_of_part.data());
                    film.add_deviations(layer, color, first, end, deviations.data());
                    const double apart = of_half.apart(of_part);
                    for (std::size_t i = 0; i < pixels; ++i) {
                        const double off = sum_of_part[i] * of_half.of_mean - sum[i] * of_part.of_mean;
                        deviations[i] += apart > 0 ? off * off / apart : 0;
                        sum[i] += sum_of_part[i];
                    }
                    of_half.add(of_part);
                }
                if (of_half.of_deviations <= 0)
                    continue;
                const double of_mean = of_half.squares / (of_half.of_deviations * weight * weight);
                for (std::size_t i = 0; i < pixels; ++i)
                    variance[i] += of_mean * deviations[i];
            }
            for (std::size_t i = 0; i < pixels; ++i)
                plane[first + i] = static_cast<float>(variance[i]);
        });
    };
}

ImageSources GradientFilms::images() const {
    ImageSources images;
    constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
    images.primal = mean(GradientFilm::primal, unknown);
    images.dx = mean(GradientFilm::dx, unknown);
    images.dy = mean(GradientFilm::dy, unknown);
    images.primal_variance = variance(GradientFilm::primal);
    images.dx_variance = variance(GradientFilm::dx);
    images.dy_variance = variance(GradientFilm::dy);
    return images;
}

} // namespace gradus
