// Random numbers from counters: pairs whose counters are neighbours fill the unit square evenly, so that no two numbers
// of a render know of each other.
#include "tests/kernels/precision.h"
#include "tests/support/chi_square.h"

#include "kernels/lib/random.h"

#include <functional>
#include <gtest/gtest.h>

using namespace gradus::testing;

namespace {

constexpr std::uint32_t pixels = 512, samples = 128, resolution = 32;

/// What a render draws with this seed for a pixel (by its number), a sample and a dimension.
struct Counter {
    std::uint32_t seed = 0, pixel = 0, sample = 0, sample_high = 0, dimension = 0;
};

lib::random4 draw(Counter c) {
    const lib::random_bits key = lib::random_key(c.seed, 0, c.pixel, c.sample, c.sample_high);
    return lib::random_draw(key.x, key.y, c.dimension);
}

using First = std::function<double(const lib::random4 &)>;

/// Tests one number of each counter against another of the counter that `step` makes of it.
void expect_independent(const std::function<Counter(Counter)> &step, const First &one, const First &other,
                        const char *what) {
    constexpr int tests = 14; // calls below
    std::vector<double> counts(resolution * resolution, 0);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
        for (std::uint32_t sample = 0; sample < samples; ++sample) {
            const Counter c{1, 2 * pixel, 2 * sample, 0, 3};
            const auto cell = [](double u) { return std::size_t(u * resolution); };
            counts[cell(one(draw(c))) * resolution + cell(other(draw(step(c))))] += 1;
        }
    const std::vector<double> expected(counts.size(), double(pixels) * samples / double(counts.size()));
    EXPECT_GT(chi_square(counts, expected).p_value, sidak_level(1e-3, tests)) << what;
}

double a(const lib::random4 &u) { return double(u.a); }
double b(const lib::random4 &u) { return double(u.b); }
double c(const lib::random4 &u) { return double(u.c); }
double d(const lib::random4 &u) { return double(u.d); }

Counter same(Counter counter) { return counter; }

} // namespace

TEST(Random, NumbersOfADrawAreIndependent) {
    expect_independent(same, a, b, "a and b");
    expect_independent(same, a, c, "a and c");
    expect_independent(same, a, d, "a and d");
    expect_independent(same, b, c, "b and c");
    expect_independent(same, b, d, "b and d");
    expect_independent(same, c, d, "c and d");
}

TEST(Random, NeighboursAreIndependent) {
    const struct {
        const char *what;
        std::function<Counter(Counter)> step;
    } cases[] = {{"the next pixel",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel + 1, n.sample, 0, n.dimension};
                  }},
                 {"the pixel below",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel + 640, n.sample, 0, n.dimension};
                  }},
                 {"the next sample",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel, n.sample + 1, 0, n.dimension};
                  }},
                 {"2^32 samples on",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel, n.sample, 1, n.dimension};
                  }},
                 {"the next dimension",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel, n.sample, 0, n.dimension - 1};
                  }},
                 {"the dimension before",
                  [](Counter n) {
                      return Counter{n.seed, n.pixel, n.sample, 0, n.dimension + 1};
                  }},
                 {"another seed",
                  [](Counter n) {
                      return Counter{n.seed + 1, n.pixel, n.sample, 0, n.dimension};
                  }},
                 {"pixel and sample exchanged", [](Counter n) {
                      return Counter{n.seed, n.sample + 1, n.pixel, 0, n.dimension};
                  }}};
    for (const auto &neighbour : cases)
        expect_independent(neighbour.step, a, a, neighbour.what);
}

TEST(Random, NumbersAreBelowOne) {
    EXPECT_LT(double(lib::random_unit(0xFFFFFFFFu)), 1.0);
    EXPECT_EQ(double(lib::random_unit(0)), 0.0);
}
