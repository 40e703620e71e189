// Sums of films against each pixel's by itself: films are summed in blocks, of which each has one number of samples.
#include "kernels/shared/tables.h"
#include "methods/gradient_films.h"
#include "runtime/device/device.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace gradus::testing {
namespace {

using namespace lib_float;

constexpr std::uint32_t film_width = 37, film_height = 41;
constexpr std::size_t film_pixels = film_width * film_height;

/// A film whose values are random, after so many samples.
struct RandomFilm {
    std::vector<float> values = std::vector<float>(gradient_film_columns * film_pixels);
    std::uint64_t samples;

    RandomFilm(unsigned seed, std::uint64_t samples) : samples(samples) {
        std::mt19937 random(seed);
        for (float &value : values)
            value = std::uniform_real_distribution<float>(0.5f, 9)(random);
    }
    double at(int column, std::size_t pixel) const { return values[std::size_t(column) * film_pixels + pixel]; }
    /// Of a difference to the pixel below there are as many as of both pixels.
    double count(int layer, std::size_t pixel) const {
        const std::size_t last = pixel + (layer == GradientFilm::dy ? film_width : 0);
        return double(samples / film_pixels) + (last < samples % film_pixels ? 1 : 0);
    }
    double sum(int layer, int color, std::size_t pixel) const {
        return at(gradient_film_primal_r + 3 * layer + color, pixel) +
               at(gradient_film_correction_first + 3 * layer + color, pixel);
    }
    /// The film has squared deviations from the mean.
    double squares(int layer, int color, std::size_t pixel) const {
        return at(gradient_film_deviation_first + 3 * layer + color, pixel) +
               std::pow(sum(layer, color, pixel), 2) / count(layer, pixel);
    }
};

/// Without a border.
constexpr SampledArea film_area{film_width, film_height, 0};

TEST(GradientFilms, AreSummedPixelByPixel) {
    SceneMaker maker(film_width, film_height);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5)), 0);
    Tracer tracer(maker.scene, 2);
    Device device;
    // Parts of the even and the odd half; of each the last frame is there in part.
    const std::vector<RandomFilm> films = {RandomFilm(1, 3 * film_pixels + 700), RandomFilm(2, 3 * film_pixels + 20),
                                           RandomFilm(3, 2 * film_pixels + 1500), RandomFilm(4, 2 * film_pixels)};
    std::vector<Buffer> buffers;
    for (const RandomFilm &film : films)
        buffers.emplace_back(device, "gradient_film", film.values.data(), film.values.size() * sizeof(float));
    GradientFilms all(tracer, true);
    for (std::size_t i = 0; i < films.size(); ++i)
        all.add(buffers[i], film_area, Precision::single, films[i].samples);

    std::vector<float> mean(film_pixels), variance(film_pixels);
    for (const auto layer : {GradientFilm::primal, GradientFilm::dx, GradientFilm::dy})
        for (int color = 0; color < 3; ++color) {
            all.mean(layer)(std::uint32_t(color), mean.data());
            all.variance(layer)(std::uint32_t(color), variance.data());
            for (std::size_t pixel = 0; pixel < film_pixels; ++pixel) {
                double n = 0, sum = 0, expected = 0;
                for (const RandomFilm &film : films) {
                    n += film.count(layer, pixel);
                    sum += film.sum(layer, color, pixel);
                }
                for (const std::size_t half : {0u, 1u}) {
                    const RandomFilm &a = films[half], &b = films[half + 2];
                    const double of_half = a.count(layer, pixel) + b.count(layer, pixel);
                    const double m = (a.sum(layer, color, pixel) + b.sum(layer, color, pixel)) / of_half;
                    const double square = (a.squares(layer, color, pixel) + b.squares(layer, color, pixel)) / of_half;
                    expected += std::pow(of_half / n, 2) * std::max(0.0, square - m * m) / (of_half - 1);
                }
                ASSERT_NEAR(mean[pixel], sum / n, 1e-6 * sum / n) << layer << ", pixel " << pixel;
                ASSERT_NEAR(variance[pixel], expected, 1e-6) << layer << ", pixel " << pixel;
            }
        }
}

/// A half of one sample tells no variance; two or three samples are as independent of each other as any.
TEST(GradientFilms, OfFewSamplesTellTheVarianceOfAll) {
    SceneMaker maker(film_width, film_height);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5)), 0);
    Tracer tracer(maker.scene, 2);
    Device device;
    // From three samples of each pixel to two: the odd half has one, and the even one perhaps one more.
    RandomFilm even(1, film_pixels + 700), odd(2, film_pixels);
    for (int deviation = gradient_film_deviation_first; deviation < gradient_film_deviation_first + 9; ++deviation)
        for (std::size_t pixel = 0; pixel < film_pixels; ++pixel) { // one sample has none
            odd.values[std::size_t(deviation) * film_pixels + pixel] = 0;
            const int layer = (deviation - gradient_film_deviation_first) / 3;
            if (even.count(layer, pixel) == 1)
                even.values[std::size_t(deviation) * film_pixels + pixel] = 0;
        }
    GradientFilms films(tracer, true);
    std::vector<Buffer> buffers;
    for (const RandomFilm *film : {&even, &odd})
        buffers.emplace_back(device, "gradient_film", film->values.data(), film->values.size() * sizeof(float));
    films.add(buffers[0], film_area, Precision::single, even.samples);
    films.add(buffers[1], film_area, Precision::single, odd.samples);
    std::vector<float> variance(film_pixels);
    for (const auto layer : {GradientFilm::primal, GradientFilm::dx, GradientFilm::dy}) {
        films.variance(layer)(0, variance.data());
        for (std::size_t pixel = 0; pixel < film_pixels; ++pixel) {
            const double n = even.count(layer, pixel) + odd.count(layer, pixel);
            const double mean = (even.sum(layer, 0, pixel) + odd.sum(layer, 0, pixel)) / n;
            const double squares = even.squares(layer, 0, pixel) + odd.squares(layer, 0, pixel);
            const double expected = (squares - n * mean * mean) / (n * (n - 1));
            ASSERT_NEAR(variance[pixel], expected, 1e-5 * (1 + mean * mean)) << layer << ", pixel " << pixel;
        }
    }
}

/// A pixel whose first sample is still to come is 0 in a mean, and missing for a solver. A difference to the pixel
/// below needs both.
TEST(GradientFilms, WithoutASampleAreMissing) {
    SceneMaker maker(film_width, film_height);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5)), 0);
    Tracer tracer(maker.scene, 2);
    Device device;
    const RandomFilm film(1, 3 * film_width);
    const Buffer buffer(device, "gradient_film", film.values.data(), film.values.size() * sizeof(float));
    GradientFilms films(tracer);
    films.add(buffer, film_area, Precision::single, film.samples);
    EXPECT_EQ(films.pixels_with_samples(), 3 * film_width);
    const ImageSources images = films.images();
    std::vector<float> mean(film_pixels), solved(film_pixels);
    for (const auto &[layer, image] : {std::pair{GradientFilm::primal, images.primal},
                                       {GradientFilm::dx, images.dx},
                                       {GradientFilm::dy, images.dy}}) {
        films.mean(layer)(0, mean.data());
        image(0, solved.data());
        for (std::size_t pixel = 0; pixel < film_pixels; ++pixel) {
            const double expected = film.count(layer, pixel) > 0 ? film.sum(layer, 0, pixel) : 0;
            ASSERT_FLOAT_EQ(mean[pixel], float(expected)) << layer << ", pixel " << pixel;
            if (film.count(layer, pixel) > 0)
                ASSERT_EQ(solved[pixel], mean[pixel]) << layer << ", pixel " << pixel;
            else
                ASSERT_TRUE(std::isnan(solved[pixel])) << layer << ", pixel " << pixel;
        }
    }
}

/// A film whose table has rows for a border too: the image is what lies within, and has no difference to what does not.
/// Of the last frame the upper rows have a sample more, the border's counted in.
TEST(GradientFilms, LeaveTheirBorderOut) {
    SceneMaker maker(film_width, film_height);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5)), 0);
    Tracer tracer(maker.scene, 2);
    Device device;
    for (const std::uint32_t border : {1u, 3u}) {
        const SampledArea area{film_width - 2 * border, film_height - 2 * border, border};
        // Up to the middle of a row, within the border beside it, above the image, below it, and all.
        for (const std::size_t more :
             {std::size_t(15 * film_width + 20), std::size_t(16 * film_width + 1), std::size_t(17 * film_width - 1),
              std::size_t(5), std::size_t((film_height - border) * film_width + 4), std::size_t(0)}) {
            const RandomFilm film(1, 2 * film_pixels + more);
            const Buffer buffer(device, "gradient_film", film.values.data(), film.values.size() * sizeof(float));
            GradientFilms films(tracer);
            films.add(buffer, area, Precision::single, film.samples);
            ASSERT_EQ(films.pixels(), std::size_t(area.width) * area.height);
            EXPECT_EQ(films.frames(), 2u);
            std::vector<float> mean(films.pixels());
            std::size_t samples = 0;
            for (const auto layer : {GradientFilm::primal, GradientFilm::dx, GradientFilm::dy}) {
                films.mean(layer)(1, mean.data());
                for (std::size_t pixel = 0; pixel < films.pixels(); ++pixel) {
                    const std::size_t x = pixel % area.width, y = pixel / area.width;
                    const std::size_t row = (y + border) * film_width + x + border;
                    const bool is_outside = (layer == GradientFilm::dx && x + 1 == area.width) ||
                                            (layer == GradientFilm::dy && y + 1 == area.height);
                    const double expected = is_outside ? 0 : film.sum(layer, 1, row) / film.count(layer, row);
                    ASSERT_FLOAT_EQ(mean[pixel], float(expected)) << layer << ", " << x << ", " << y << ", " << more;
                    samples += layer == GradientFilm::primal ? std::size_t(film.count(layer, row)) : 0;
                }
            }
            EXPECT_EQ(films.samples(), samples) << more;
        }
    }
}

} // namespace
} // namespace gradus::testing
