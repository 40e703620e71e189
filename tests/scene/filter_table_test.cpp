// Pixel filters, and how samples at one place in all pixels are shared among these.
#include "runtime/scene/filter_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numeric>
#include <vector>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/lib/filter_table.h"

namespace gradus {
namespace {

using namespace lib_float;

using Filter = FilmSettings::Filter;

FilmSettings film_of(Filter filter, float radius, float stddev = 0.5f) {
    FilmSettings film;
    film.filter = filter;
    film.filter_radius = radius;
    film.filter_stddev = stddev;
    return film;
}

FilmSettings mitchell_of(float b, float c) {
    FilmSettings film = film_of(Filter::mitchell, 2);
    film.mitchell_b = b;
    film.mitchell_c = c;
    return film;
}

/// Usual ones, ones that are narrower than a pixel, ones that are much wider, and ones whose lobes are large.
std::vector<FilmSettings> all_films() {
    return {film_of(Filter::tent, 1),
            film_of(Filter::tent, 0.3f),
            film_of(Filter::tent, 0.6f),
            film_of(Filter::tent, 1.7f),
            film_of(Filter::tent, 40),
            film_of(Filter::gaussian, 2),
            film_of(Filter::gaussian, 0.4f, 0.1f),
            film_of(Filter::gaussian, 0.6f, 0.15f),
            film_of(Filter::gaussian, 1.2f, 0.8f),
            film_of(Filter::gaussian, 40, 10),
            film_of(Filter::catmullrom, 2),
            mitchell_of(1 / 3.0f, 1 / 3.0f),
            mitchell_of(0, 1),
            mitchell_of(-10, 10),
            mitchell_of(10, -10),
            film_of(Filter::lanczos, 1),
            film_of(Filter::lanczos, 2),
            film_of(Filter::lanczos, 3),
            film_of(Filter::lanczos, 20)};
}

std::string name_of(const FilmSettings &film) {
    return "filter " + std::to_string(int(film.filter)) + " of radius " + std::to_string(film.filter_radius) +
           ", deviation " + std::to_string(film.filter_stddev) + ", B " + std::to_string(film.mitchell_b);
}

TEST(FilterTable, FiltersAreMitsubas) { // mitsuba 3.9.1, ReconstructionFilter.eval
    const auto expect = [](const FilmSettings &film, std::initializer_list<double> values) {
        double x = 0;
        for (const double value : values) {
            EXPECT_NEAR(filter_value(film, x), value, 1e-6) << x;
            EXPECT_NEAR(filter_value(film, -x), value, 1e-6) << x;
            x += 0.5;
        }
    };
    expect(film_of(Filter::mitchell, 2), {0.888888955, 0.534722268, 0.0555556230, -0.0347219668, 0});
    expect(mitchell_of(0.5f, 0.25f), {0.833333373, 0.520833373, 0.0833333358, -0.0208333395, 0});
    expect(film_of(Filter::catmullrom, 2), {1, 0.5625, 0, -0.0625, 0});
    expect(film_of(Filter::lanczos, 3), {1, 0.607927084, 0, -0.135094911, 0, 0.0243170746, 0});
    expect(film_of(Filter::lanczos, 2), {1, 0.573159158, 0, -0.0636843517, 0});
}

TEST(FilterTable, OfABoxIsEmpty) {
    EXPECT_TRUE(make_filter_table(film_of(Filter::box, 0.5f)).offsets.empty());
    EXPECT_EQ(filter_reach(film_of(Filter::box, 7)), 0u); // whatever it says
}

TEST(FilterTable, ReachesAsFarAsTheFilter) {
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 0.3f)), 0u);
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 0.5f)), 0u);
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 0.6f)), 1u);
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 1)), 1u);
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 1.5f)), 1u);
    EXPECT_EQ(filter_reach(film_of(Filter::tent, 1.6f)), 2u);
    EXPECT_EQ(filter_reach(film_of(Filter::gaussian, 2)), 2u);
    EXPECT_EQ(filter_reach(film_of(Filter::lanczos, 3)), 3u);
}

/// So that a constant image stays one, whatever the samples are, and however many.
TEST(FilterTable, TapsSumUpToOne) {
    for (const FilmSettings &film : all_films()) {
        const FilterTable table = make_filter_table(film);
        const std::uint32_t reach = filter_reach(film);
        double worst = 0;
        for (std::uint32_t i = 0; i < 10'000; ++i) {
            const filter_place place = filter_place_at(filter_number(filter_place_of((float(i) + 0.5f) / 10'000)));
            double sum = 0, magnitude = 0;
            for (std::uint32_t tap = 0; tap <= 2 * reach; ++tap) {
                const double weight = filter_tap(table.taps.data(), reach, place, tap);
                sum += weight;
                magnitude += std::fabs(weight);
            }
            worst = std::max(worst, std::fabs(sum - 1) / magnitude);
        }
        EXPECT_LT(worst, 3e-7) << name_of(film);
    }
}

/// What a sample weighs for a pixel is all that the filter has there: up to any place, the mean of weights of samples
/// before that place is the filter's integral, which is what an edge there shows.
TEST(FilterTable, WeighsByTheFilter) {
    for (const FilmSettings &film : all_films()) {
        const FilterTable table = make_filter_table(film);
        const int reach = int(filter_reach(film));
        const double radius = film.filter_radius;
        constexpr int steps = 1 << 17;
        const auto at = [&](int i) { return ((i + 0.5) / steps * 2 - 1) * radius; };
        double whole = 0, magnitude = 0;
        for (int i = 0; i < steps; ++i) {
            whole += filter_value(film, at(i));
            magnitude += std::fabs(filter_value(film, at(i)));
        }
        for (int tap = 0; tap <= 2 * reach; tap += std::max(1, reach / 4)) {
            double exact = 0, drawn = 0, worst = 0;
            // Places of the pixel that this tap is of lie around reach - tap.
            int i = 0;
            for (std::uint32_t cell = 0; cell < filter_cells; ++cell) {
                const double begin = table.taps[std::size_t(cell) * std::size_t(4 * reach + 2) + std::size_t(tap)];
                const double end =
                    table.taps[std::size_t(cell) * std::size_t(4 * reach + 2) + std::size_t(2 * reach + 1 + tap)];
                drawn += (begin + end) / (2.0 * filter_cells);
                for (; i < steps && at(i) < table.offsets[cell + 1] - (tap - reach); ++i)
                    if (at(i) >= table.offsets[0] - (tap - reach))
                        exact += filter_value(film, at(i)) / whole;
                worst = std::max(worst, std::fabs(drawn - exact));
            }
            // A step of the sum, and what is normalised away where the filter is narrower than a pixel.
            EXPECT_LT(worst, (3.0 * 2 * radius / steps + 3e-5) * magnitude / std::fabs(whole))
                << name_of(film) << ", tap " << tap;
            EXPECT_NEAR(table.mean_taps[std::size_t(tap)], drawn, 1e-5 * magnitude / std::fabs(whole))
                << name_of(film) << ", tap " << tap;
        }
        EXPECT_NEAR(std::accumulate(table.mean_taps.begin(), table.mean_taps.end(), 0.0), 1, 1e-9) << name_of(film);
    }
}

TEST(FilterTable, CellsAreInOrderAndWithinThePixel) {
    for (const FilmSettings &film : all_films()) {
        const FilterTable table = make_filter_table(film);
        ASSERT_EQ(table.offsets.size(), std::size_t(filter_cells) + 1);
        EXPECT_TRUE(std::ranges::is_sorted(table.offsets)) << name_of(film);
        const float half = std::min(0.5f, film.filter_radius);
        EXPECT_EQ(table.offsets.front(), -half) << name_of(film);
        EXPECT_EQ(table.offsets.back(), half) << name_of(film);
        for (const float u : {0.0f, 0.25f, 0.999f, 0x1.fffffep-1f}) {
            const filter_place place = filter_place_of(u), again = filter_place_at(filter_number(place));
            EXPECT_EQ(again.cell, place.cell);
            EXPECT_NEAR(again.share, place.share, 0x1p-18f);
            EXPECT_LE(std::fabs(filter_offset(table.offsets.data(), place)), half);
        }
    }
}

/// The cell behind the others, for samples that are to count for their own pixels alone.
TEST(FilterTable, HasACellOfSamplesThatAreNotShared) {
    const FilmSettings film = film_of(Filter::lanczos, 3);
    const FilterTable table = make_filter_table(film);
    for (std::uint32_t tap = 0; tap < 7; ++tap)
        EXPECT_EQ(filter_tap(table.taps.data(), 3, {filter_cells, 0}, tap), tap == 3 ? 1 : 0);
}

/// The mean square of weights is the noise that is left of white noise: for a Gaussian of half a pixel 0.32 of it.
TEST(FilterTable, LeavesLessNoise) {
    const auto left = [](const FilmSettings &film) {
        const FilterTable table = make_filter_table(film);
        const std::uint32_t reach = filter_reach(film);
        double sum = 0;
        for (std::uint32_t i = 0; i < 4096; ++i)
            for (std::uint32_t tap = 0; tap <= 2 * reach; ++tap)
                sum += std::pow(filter_tap(table.taps.data(), reach, {i, 0.5f}, tap), 2) / 4096;
        return sum * sum; // along both axes
    };
    EXPECT_NEAR(left(film_of(Filter::gaussian, 2)), 0.318, 0.003); // 1 / (4 pi s^2)
    EXPECT_NEAR(left(film_of(Filter::tent, 1)), 4 / 9.0, 0.002);
    EXPECT_LT(left(film_of(Filter::mitchell, 2)), 0.55);
    EXPECT_LT(left(film_of(Filter::lanczos, 3)), 1);
    EXPECT_EQ(left(film_of(Filter::gaussian, 0.4f, 0.1f)), 1);
}

} // namespace
} // namespace gradus
