// The two halves of a render's samples: independent of each other, the same in strips and batches of any size, and what
// the weighted reconstruction makes of them is unbiased.
#include "methods/gradient_image.h"
#include "runtime/wavefront/sample_parts.h"
#include "solver/weighted_reconstruction.h"
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/stability.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>

namespace gradus::testing {
namespace {

RenderOptions weighted_options(std::uint64_t seed = 0) {
    RenderOptions options;
    options.seed = seed;
    options.reconstruction = Reconstruction::weighted;
    return options;
}

Scene small_scene(const char *name, std::uint32_t width, std::uint32_t height, std::uint64_t samples) {
    Scene scene = own_scene(fmt::format("{}.xml", name), width, height);
    scene.settings.samples_per_pixel = samples;
    return scene;
}

/// A layer of three colours as the solver has it.
std::vector<float> planes_of(const Image &image, const std::string &name) {
    std::vector<float> planes;
    for (const char *color : colors) {
        const std::vector<float> &values = image.find(name + "." + color)->values;
        planes.insert(planes.end(), values.begin(), values.end());
    }
    return planes;
}

bool layer_is_equal(const Image &a, const Image &b, const std::string &name) {
    const std::vector<float> first = planes_of(a, name), second = planes_of(b, name);
    return std::memcmp(first.data(), second.data(), first.size() * sizeof(float)) == 0;
}

/// The halves in the layers of an image, on the device.
HalvedImages halves_of(const Image &image, std::uint64_t samples) {
    const std::uint64_t pixels = std::uint64_t(image.width) * image.height;
    HalvedImages halves;
    for (int i = 0; i < 2; ++i) {
        const auto buffer = [&](const std::string &layer, const char *what) {
            const std::vector<float> planes = planes_of(image, fmt::format("{}_{}{}", layer, i ? "odd" : "even", what));
            return Buffer(shared_device(), layer, planes.data(), planes.size() * sizeof(float));
        };
        halves[i] = {buffer("primal", ""),
                     buffer("dx", ""),
                     buffer("dy", ""),
                     buffer("primal", "_variance"),
                     buffer("dx", "_variance"),
                     buffer("dy", "_variance"),
                     samples_of_part(samples, pixels, std::uint32_t(i), 2)};
    }
    return halves;
}

std::vector<float> read(const Buffer &buffer) {
    std::vector<float> values(buffer.bytes() / sizeof(float));
    buffer.read(values.data(), buffer.bytes());
    return values;
}

TEST(GradientHalves, AreTheSameInStripsOfAnyHeight) {
    constexpr std::uint32_t width = 96, height = 11;
    for (const std::uint64_t samples : {5u, 8u}) {
        const Scene scene = small_scene("cornell-box", width, height, samples);
        const Image whole = render(scene, weighted_options(), "gpt").image;
        for (const std::uint32_t paths : {width / 4, width, 11 * width / 4, 3 * 11 * width / 4}) {
            RenderOptions options = weighted_options();
            options.batch_size = paths;
            EXPECT_TRUE(equal_bits(whole, render(scene, options, "gpt").image)) << samples << ", " << paths;
        }
    }
}

/// Half a frame more: rows that have a sample more are divided by their own number.
TEST(GradientHalves, GiveTheirImageInTheMiddleOfAFrame) {
    constexpr std::uint32_t width = 128, height = 12;
    const Image of_4 = render(small_scene("cornell-box", width, height, 4), weighted_options(), "gpt").image,
                of_6 = render(small_scene("cornell-box", width, height, 6), weighted_options(), "gpt").image;
    RenderOptions options = weighted_options();
    options.layers = true;
    options.batch_size = 64; // strips of 2 rows
    const auto method = make_method("gpt", shared_device(), small_scene("cornell-box", width, height, 6), options);
    while (method->done_samples() < (4 * height + 6) * width)
        method->render_batch();
    ASSERT_EQ(method->done_samples(), (4 * height + 6) * width);
    const Image image = method->image();
    EXPECT_EQ(count_non_finite(image), 0u);
    EXPECT_TRUE(layer_is_equal(image, of_4, "primal_odd")) << "the fifth sample is an even one";
    const std::vector<float> mixed = planes_of(image, "primal_even"), more = planes_of(of_6, "primal_even"),
                             less = planes_of(of_4, "primal_even");
    for (std::size_t i = 0; i < mixed.size(); ++i)
        ASSERT_EQ(mixed[i], i / width % height < 6 ? more[i] : less[i]) << i;
}

TEST(GradientHalves, OfAnOddCountHaveOneMoreEvenSample) {
    const Image of_4 = render(small_scene("cornell-box", 32, 32, 4), weighted_options(), "gpt").image,
                of_5 = render(small_scene("cornell-box", 32, 32, 5), weighted_options(), "gpt").image,
                of_6 = render(small_scene("cornell-box", 32, 32, 6), weighted_options(), "gpt").image;
    for (const char *layer : {"primal", "dx", "dy"})
        for (const char *what : {"", "_variance"}) {
            EXPECT_TRUE(layer_is_equal(of_5, of_6, fmt::format("{}_even{}", layer, what))) << layer << what;
            EXPECT_TRUE(layer_is_equal(of_5, of_4, fmt::format("{}_odd{}", layer, what))) << layer << what;
        }
    const std::vector<float> even = planes_of(of_5, "primal_even"), odd = planes_of(of_5, "primal_odd"),
                             all = planes_of(of_5, "primal");
    for (std::size_t i = 0; i < all.size(); ++i)
        ASSERT_NEAR(all[i], 0.6 * even[i] + 0.4 * odd[i], 1e-6 * (even[i] + odd[i]));
}

/// `gradus solve` has no more than these.
TEST(GradientHalves, InTheLayersMakeTheImageAgain) {
    for (const std::uint64_t samples : {4u, 7u}) {
        const Image image = render(small_scene("cornell-box", 40, 24, samples), weighted_options(), "gpt").image;
        PoissonSolver solver(shared_device(), image.width, image.height, 3);
        Buffer result(shared_device(), "result", 3 * sizeof(float) * image.width * image.height);
        WeightedReconstruction(shared_device(), solver)
            .solve(halves_of(image, samples * image.width * image.height), result);
        const std::vector<float> solved = read(result), direct = planes_of(image, "direct");
        const std::size_t pixels = std::size_t(image.width) * image.height;
        for (std::size_t i = 0; i < solved.size(); ++i)
            ASSERT_EQ(direct[i] + solved[i], image.find(colors[i / pixels])->values[i % pixels]) << i;
    }
}

TEST(GradientHalves, OfOneSampleAreNone) {
    for (const std::uint64_t samples : {1u, 3u, 4u}) {
        const Rendered rendered = render(small_scene("cornell-box", 24, 24, samples), weighted_options(), "gpt");
        const ReconstructionUsed &used = rendered.statistics.reconstruction;
        EXPECT_EQ(used.name, samples < 4 ? "l1" : "weighted");
        EXPECT_EQ(used.accuracy, samples < 4 ? "consistent" : "unbiased");
        EXPECT_EQ(used.note.empty(), samples == 4) << used.note;
        if (samples > 1)
            continue;
        RenderOptions l1;
        l1.reconstruction = Reconstruction::l1;
        const Image image = render(small_scene("cornell-box", 24, 24, samples), l1, "gpt").image;
        for (const char *color : colors)
            EXPECT_EQ(image.find(color)->values, rendered.image.find(color)->values) << "the first sample is the same";
    }
}

/// Errors of the halves' means by pixel: their products are zero on average over seeds. Of a plain part of the back
/// wall, for what pixels share is common to both halves: at edges the places of the samples, which follow one sequence,
/// make errors of opposite sign, and no weights turn these into a bias (solver/weighted_reconstruction.h).
TEST(GradientHalves, AreIndependent) {
    constexpr std::size_t seeds = 48;
    Scene scene = small_scene("cornell-box", 96, 96, 4);
    scene.film.crop_x = 52;
    scene.film.crop_y = 26;
    scene.film.crop_width = scene.film.crop_height = 24;
    std::vector<std::vector<double>> even, odd;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Image image = render(scene, weighted_options(seed), "gpt").image;
        const std::vector<float> a = planes_of(image, "dx_even"), b = planes_of(image, "dx_odd");
        even.emplace_back(a.begin(), a.end());
        odd.emplace_back(b.begin(), b.end());
    }
    const std::size_t count = even[0].size();
    std::vector<double> mean(count, 0.0);
    for (std::size_t s = 0; s < seeds; ++s)
        for (std::size_t i = 0; i < count; ++i)
            mean[i] += (even[s][i] + odd[s][i]) / (2 * seeds);
    // The mean has a part of either error, 1 / (2 seeds), which their product loses: added again.
    std::vector<double> products(seeds, 0.0);
    double squares = 0;
    for (std::size_t s = 0; s < seeds; ++s)
        for (std::size_t i = 0; i < count; ++i) {
            const double a = even[s][i] - mean[i], b = odd[s][i] - mean[i];
            products[s] += a * b + (a * a + b * b) / 2 / (2 * seeds - 1);
            squares += (a * a + b * b) / 2 / seeds;
        }
    const Spread spread = spread_of(products);
    const double correlation = spread.mean / squares, z = spread.mean / spread.standard_error;
    std::printf("correlation of the halves' errors %.4f, %.1f standard errors\n", correlation, z);
    EXPECT_LE(std::fabs(z), 4);
    EXPECT_LE(std::fabs(correlation), 0.1) << "too noisy to tell";
}

/// Depth is what the places of the samples make of it: one even sequence, whether or not there are halves.
TEST(GradientHalves, FillThePixelTogether) {
    const Scene scene = small_scene("cornell-box", 32, 32, 7);
    RenderOptions options = weighted_options(), whole = weighted_options();
    options.aov = whole.aov = true;
    options.variance = whole.variance = false; // for which places are drawn apart
    whole.reconstruction = Reconstruction::l1;
    EXPECT_EQ(render(scene, options, "gpt").image.find("depth.Z")->values,
              render(scene, whole, "gpt").image.find("depth.Z")->values);
}

struct BiasCase {
    const char *scene;
    std::uint32_t side;
    std::size_t seeds;
    std::uint64_t samples;
    bool is_recorded; ///< in docs/stability.md: not those that few runs do
};

class WeightedBias : public ::testing::TestWithParam<BiasCase> {};

/// Held against the same samples' mean, which is unbiased: both share most of their noise. And so that the test can
/// fail: with weights of the same half it does.
TEST_P(WeightedBias, IsNone) {
    const BiasCase c = GetParam();
    const Scene scene = small_scene(c.scene, c.side, c.side, c.samples);
    std::vector<std::vector<double>> weighted, own, means;
    std::vector<double> totals;
    PoissonSolver solver(shared_device(), c.side, c.side, 3);
    WeightedReconstruction reconstruction(shared_device(), solver);
    Buffer result(shared_device(), "result", 3 * sizeof(float) * c.side * c.side);
    for (std::uint64_t seed = 1; seed <= c.seeds; ++seed) {
        const Image image = render(scene, weighted_options(seed), "gpt").image;
        weighted.push_back(values_of(image));
        means.push_back(values_of(whole(image)));
        double total = 0;
        for (std::size_t i = 0; i < weighted.back().size(); ++i)
            total += (weighted.back()[i] - means.back()[i]) / double(weighted.back().size());
        totals.push_back(total);
        const HalvedImages halves = halves_of(image, c.samples * c.side * c.side);
        const std::vector<float> direct = planes_of(image, "direct");
        std::vector<double> mine(direct.begin(), direct.end());
        for (int half = 0; half < 2; ++half) {
            reconstruction.solve_half(halves[half], halves[half], result);
            const std::vector<float> solved = read(result);
            for (std::size_t i = 0; i < mine.size(); ++i)
                mine[i] += 0.5 * solved[i];
        }
        own.push_back(mine);
    }
    /// Blocks of 8 x 8 pixels: noise averages out, a bias that has one sign does not.
    const auto blocks = [&](const std::vector<std::vector<double>> &images) {
        std::vector<std::vector<double>> all;
        const std::uint32_t across = c.side / 8;
        for (const std::vector<double> &image : images) {
            std::vector<double> sums(3 * std::size_t(across) * across, 0.0);
            for (std::size_t i = 0; i < image.size(); ++i) {
                const std::size_t x = i % c.side, y = i / c.side % c.side, channel = i / c.side / c.side;
                sums[(channel * across + y / 8) * across + x / 8] += image[i] / 64;
            }
            all.push_back(sums);
        }
        return all;
    };
    const BiasEstimate bias = estimate_bias(blocks(weighted), blocks(means)),
                       of_own = estimate_bias(blocks(own), blocks(means));
    const Spread total = spread_of(totals);
    const double z = total.mean / total.standard_error;
    std::printf("%s, %d seeds of %d samples: squared bias of blocks %.1f standard errors, image %.1f, relative bias at "
                "most %.2g; with weights of the same half %.1f standard errors\n",
                c.scene, int(c.seeds), int(c.samples), bias.squared / bias.standard_error, z, bias.at_most(),
                of_own.squared / of_own.standard_error);
    EXPECT_TRUE(bias.is_none());
    EXPECT_LE(std::fabs(z), 4);
    EXPECT_FALSE(of_own.is_none()) << "the test cannot see a bias";
    if (!c.is_recorded)
        return;
    record_stability({"Reconstruction", "weights from the variances of the same samples darken what is skewed",
                      fmt::format("scenes/{}.xml, {} seeds of {} samples", c.scene, c.seeds, c.samples),
                      "unbiased: each half takes the other's variances", "bias of blocks of 8 x 8 at most",
                      bias.at_most(), 0.02});
}

INSTANTIATE_TEST_SUITE_P(Scenes, WeightedBias, ::testing::Values(BiasCase{"cornell-box", 32, 40, 4, true}));
INSTANTIATE_TEST_SUITE_P(Full, WeightedBias,
                         ::testing::Values(BiasCase{"cornell-box", 48, 64, 16, false},
                                           BiasCase{"plates", 48, 64, 4, false}, BiasCase{"plates", 48, 64, 16, false},
                                           BiasCase{"door-ajar", 48, 64, 4, false},
                                           BiasCase{"door-ajar", 48, 64, 16, false}));

} // namespace
} // namespace gradus::testing
