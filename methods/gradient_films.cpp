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
    if (is_outside(layer, pixel))
        return 0;
    return table_.real(gradient_film_primal_r + number, area_.number_of(pixel)) +
           table_.real(gradient_film_correction_first + number, area_.number_of(pixel));
}

void GradientFilm::add_sums(Layer layer, std::uint32_t color, std::size_t first, std::size_t end, double *to) const {
    const int number = 3 * layer + int(color);
    Values sums{};
    const std::size_t row = area_.number_of(first), end_of_rows = row + end - first;
    table_.add_reals(gradient_film_primal_r + number, row, end_of_rows, sums.data());
    table_.add_reals(gradient_film_correction_first + number, row, end_of_rows, sums.data());
    for (std::size_t i = 0; i < end - first; ++i)
        to[i] += is_outside(layer, first + i) ? 0 : sums[i];
}

void GradientFilm::add_deviations(Layer layer, std::uint32_t color, std::size_t first, std::size_t end,
                                  double *to) const {
    Values deviations{};
    const std::size_t row = area_.number_of(first);
    table_.add_reals(gradient_film_deviation_first + 3 * layer + int(color), row, row + end - first, deviations.data());
    for (std::size_t i = 0; i < end - first; ++i)
        to[i] += is_outside(layer, first + i) ? 0 : deviations[i];
}

std::uint64_t GradientFilms::samples() const {
    std::uint64_t samples = 0;
    for (const auto &film : films_)
        samples += film->samples();
    return samples;
}

std::uint64_t GradientFilms::frames() const {
    std::uint64_t frames = 0;
    for (const auto &film : films_)
        frames += film->frames();
    return frames;
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
            double count = 0;
            for (const auto &film : films_) {
                film->add_sums(layer, color, first, end, sums.data());
                count += film->count(layer, first);
            }
            for (std::size_t i = 0; i < end - first; ++i)
                plane[first + i] = count > 0 ? static_cast<float>(sums[i] / count) : of_none;
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
                    replicates[part] = {films_[part]->sum(layer, color, pixel), films_[part]->count(layer, pixel)};
                plane[pixel] = static_cast<float>(variance_of_mean(replicates));
            }
        });
    };
}

PlaneSource GradientFilms::variance_of_samples(GradientFilm::Layer layer) const {
    return [this, layer](std::uint32_t color, float *plane) {
        for_each_block(layer, [&](std::size_t first, std::size_t end) {
            const std::size_t pixels = end - first;
            double count = 0;
            for (const auto &film : films_)
                count += film->count(layer, first);
            // A half of one sample tells no variance, while samples of both halves are independent of each other.
            const std::size_t halves = has_halves_ && count >= 4 ? 2 : 1;
            Values variance{};
            for (std::size_t half = 0; half < halves; ++half) {
                double of_half = 0;
                Values sum{}, deviations{};
                for (std::size_t part = half; part < films_.size(); part += halves) {
                    const double of_part = films_[part]->count(layer, first);
                    if (of_part == 0)
                        continue;
                    Values sum_of_part{};
                    films_[part]->add_sums(layer, color, first, end, sum_of_part.data());
                    films_[part]->add_deviations(layer, color, first, end, deviations.data());
                    // Chan et al. 1983: deviations from the mean of both.
                    const double apart = of_half * of_part * (of_half + of_part);
                    for (std::size_t i = 0; i < pixels; ++i) {
                        const double off = sum_of_part[i] * of_half - sum[i] * of_part;
                        deviations[i] += apart > 0 ? off * off / apart : 0;
                        sum[i] += sum_of_part[i];
                    }
                    of_half += of_part;
                }
                if (of_half < 2)
                    continue;
                const double of_mean = of_half / ((of_half - 1) * count * count);
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
