// The variances that an image tells of itself, against the spread of images of other seeds.
#include "tests/methods/reference_scene.h"
#include "tests/methods/variance_check.h"

#include <gmock/gmock.h>

namespace gradus::testing {
namespace {

constexpr std::uint32_t side = wall_side;

/// The same with a dark strip that lies slantingly: edges in most pixels, which places within them decide.
Scene strips(std::uint64_t samples) {
    SceneMaker maker(side, samples);
    maker.scene = smooth_wall(samples);
    const std::uint32_t black = maker.material(diffuse(0.05));
    for (int i = -8; i < 8; ++i)
        maker.parallelogram({0.12f * float(i), 0.001f, -1}, {0.2f, 0, 2}, {0.06f, 0, 0}, black);
    return maker.scene;
}

void expect_right_everywhere(std::size_t seeds, double most) {
    // 6: replicates of unequal counts. The spread of all samples of one sequence would tell 2.0, 2.2 and 2.7
    // times the variance, and with strips 2.8 times.
    for (const std::uint64_t samples : {2u, 6u, 64u}) {
        const std::vector<Image> images = render_seeds(smooth_wall(samples), seeds, with_aov());
        expect_right(told_over_true(images, "", "variance"), most, fmt::format("pt, {} samples", samples));
    }
    const std::vector<Image> images = render_seeds(strips(16), seeds, with_aov());
    expect_right(told_over_true(images, "", "variance"), most, "pt, strips");
}

/// Gradient-domain path tracing: of the samples' mean, of the primal and of the differences. All pixels have places in
/// common, so that what they are off by is alike, and fewer numbers tell it.
void expect_right_for_gradients(std::size_t seeds, double most, const RenderOptions &options = with_aov()) {
    for (const bool edges : {false, true}) {
        const std::vector<Image> images = render_seeds(edges ? strips(16) : smooth_wall(16), seeds, options, 1, "gpt");
        const std::string of = edges ? "gpt, strips: " : "gpt: ";
        expect_right(told_over_true(images, "primal", "variance"), most, of + "the mean");
        for (const char *layer : {"primal", "dx", "dy"})
            expect_right(told_over_true(images, layer, std::string(layer) + "_variance", 1), most, of + layer);
    }
}

TEST(Variances, AreThoseOfOtherSeeds) { expect_right_everywhere(16, 0.25); }
TEST(Variances, OfGradientsAreThoseOfOtherSeeds) { expect_right_for_gradients(32, 1); }
TEST(FullVariances, AreThoseOfOtherSeeds) { expect_right_everywhere(256, 0.1); }
TEST(FullVariances, OfGradientsAreThoseOfOtherSeeds) { expect_right_for_gradients(256, 0.4); }

/// Independent samples are not taken apart, and their spread is right.
TEST(Variances, OfIndependentSamplesAreTheirs) {
    RenderOptions options = with_aov();
    options.sampler = RenderOptions::Sampler::independent;
    expect_right(told_over_true(render_seeds(smooth_wall(16), 16, options), "", "variance"), 0.25, "pt, independent");
    EXPECT_GT(told_over_true(render_seeds(smooth_wall(64), 16, options), "", "variance").ratio, 0.75);
    // So are what all pixels share. In an even sequence they told 6 to 7 times the variance.
    expect_right_for_gradients(32, 1, options);
}

/// Of three one half has but one, which tells nothing by itself.
TEST(Variances, OfThreeIndependentSamplesAreTheirs) {
    RenderOptions options = with_aov();
    options.sampler = RenderOptions::Sampler::independent;
    const std::vector<Image> images = render_seeds(smooth_wall(3), 40, options, 1, "gpt");
    for (const char *layer : {"primal", "dx", "dy"})
        expect_right(told_over_true(images, layer, std::string(layer) + "_variance", 1), 1,
                     std::string("gpt: ") + layer);
}

/// Samples count for all pixels around: the spread is that of what they add up to at a pixel.
TEST(Variances, OfFiltersWithNegativeLobesAreTheirs) {
    RenderOptions options = with_aov();
    options.sampler = RenderOptions::Sampler::independent;
    Scene scene = smooth_wall(16);
    scene.film.filter = FilmSettings::Filter::lanczos;
    scene.film.filter_radius = 3;
    expect_right(told_over_true(render_seeds(scene, 20, options), "", "variance"), 0.5, "pt");
    const std::vector<Image> images = render_seeds(scene, 20, options, 1, "gpt");
    expect_right(told_over_true(images, "primal", "variance"), 1, "gpt: the mean");
    for (const char *layer : {"primal", "dx", "dy"})
        expect_right(told_over_true(images, layer, std::string(layer) + "_variance", 1), 1,
                     std::string("gpt: ") + layer);
}

/// An evenly lit wall: noise is some 1e-4 of the value. From sums of squares the mean's could not be taken off: half of
/// the pixels would tell none. Halves have films of their own.
TEST(Variances, OfFiltersWithNegativeLobesAreTheirsWhereNoiseIsSmall) {
    SceneMaker maker(side, 16);
    maker.look({0, 1.5, -3}, {0, 0, 0}, 20, {0, 0, 1});
    maker.scene.settings.max_depth = 2;
    const std::uint32_t white = maker.material(diffuse(0.5));
    maker.floor(-4, 4, 4, white);
    maker.lamp({0, 40, 1.5f}, 0.01f, 0.01f, 1e7f, white);
    maker.scene.film.filter = FilmSettings::Filter::lanczos;
    maker.scene.film.filter_radius = 3;
    RenderOptions options = with_aov();
    options.sampler = RenderOptions::Sampler::independent;
    for (const bool halves : {false, true}) {
        options.error = halves;
        const std::vector<Image> images = render_seeds(maker.scene, 128, options);
        for (const Image &image : images)
            EXPECT_THAT(image.find("variance.G")->values, ::testing::Each(::testing::Gt(0.0f)));
        // All pixels share their places, so that few numbers tell it.
        expect_right(told_over_true(images, "", "variance"), 1, halves ? "pt, halves" : "pt");
    }
}

/// Edges: what samples weigh for the pixels around and what they show go by the same places.
TEST(FullVariances, OfFiltersWithNegativeLobesAreTheirsAtEdges) {
    RenderOptions options = with_aov();
    options.sampler = RenderOptions::Sampler::independent;
    for (const std::uint64_t samples : {16u, 64u}) {
        Scene scene = strips(samples);
        scene.film.filter = FilmSettings::Filter::lanczos;
        scene.film.filter_radius = 3;
        expect_right(told_over_true(render_seeds(scene, 400, options), "", "variance"), 0.2,
                     fmt::format("pt, {} samples", samples));
    }
}

/// Blocks of 4 x 4 pixels of pairs of seeds: (a - b) over the root of both variances is normal but for what 96 degrees
/// of freedom leave, 96 / 94 of its square.
TEST(Variances, MakeScoresOfUnitSpread) {
    constexpr std::uint32_t block = 4, pairs = 8;
    const std::vector<Image> images = render_seeds(smooth_wall(64), 2 * pairs, with_aov(), 100);
    std::vector<double> squares;
    for (std::uint32_t pair = 0; pair < pairs; ++pair)
        for (std::uint32_t y = 0; y < side; y += block)
            for (std::uint32_t x = 0; x < side; x += block) {
                double apart = 0, variance = 0;
                for (std::uint32_t i = 0; i < block * block; ++i)
                    for (int which = 0; which < 2; ++which) {
                        const Image &image = images[2 * pair + which];
                        apart += (which ? -1 : 1) * pixel(image, x + i % block, y + i / block);
                        variance += pixel(image, x + i % block, y + i / block, "variance.G");
                    }
                squares.push_back(apart * apart / variance);
            }
    // The square of a normal number has a variance of 2. Chance exceeds five standard errors in one test of a million,
    // of chi-square with 128 degrees of freedom in some 10,000.
    EXPECT_NEAR(spread_of(squares).mean, 96.0 / 94, 5 * std::sqrt(2.0 / double(squares.size())));
}

/// Replicates are samples as others are.
TEST(Variances, LeaveTheImageUnbiased) {
    RenderOptions independent;
    independent.sampler = RenderOptions::Sampler::independent;
    for (const std::uint64_t samples : {1u, 6u})
        EXPECT_TRUE(agree(fmt::format("replicates-{}", samples), render_seeds(strips(samples), 48, with_aov()),
                          render_seeds(strips(samples), 48, independent, 1000), double(samples)));
}

TEST(Variances, OfOneSampleAreNone) {
    for (const char *name : {"variance.R", "variance.G", "variance.B"})
        EXPECT_THAT(render(smooth_wall(1), with_aov()).image.find(name)->values, ::testing::Each(0.0f));
}

/// Who asks for no variance has the samples of one sequence; independent ones are the same with it and without.
TEST(Variances, CostOthersNothing) {
    const auto image_with = [](RenderOptions::Sampler sampler, bool aov, bool variance) {
        RenderOptions options;
        options.sampler = sampler;
        options.aov = aov;
        options.variance = variance;
        return render(smooth_wall(8), options).image;
    };
    const auto is_same = [](const Image &a, const Image &b) {
        return std::all_of(std::begin(colors), std::end(colors),
                           [&](const char *color) { return a.find(color)->values == b.find(color)->values; });
    };
    for (const auto sampler : {RenderOptions::Sampler::independent, RenderOptions::Sampler::sobol}) {
        const Image plain = image_with(sampler, false, true), features = image_with(sampler, true, false),
                    all = image_with(sampler, true, true);
        EXPECT_TRUE(is_same(plain, features));
        EXPECT_EQ(is_same(plain, all), sampler == RenderOptions::Sampler::independent);
        EXPECT_TRUE(features.find("depth.Z") && !features.find("variance.R") && all.find("variance.R"));
    }
}

/// Batches end anywhere: replicates, and the places in the pixel, go by a sample's number.
TEST(Variances, DoNotDependOnBatches) {
    Scene scene = strips(7);
    for (const bool is_signed : {false, true}) {
        RenderOptions options = with_aov();
        if (is_signed) {
            scene.film.filter = FilmSettings::Filter::lanczos;
            scene.film.filter_radius = 3;
            options.sampler = RenderOptions::Sampler::independent;
        }
        for (const char *method : {"pt", "gpt"}) {
            options.batch_size = 0;
            const Image whole = render(scene, options, method).image;
            for (const std::uint32_t batch : {64u, 1000u}) {
                options.batch_size = batch;
                EXPECT_TRUE(equal_bits(whole, render(scene, options, method).image)) << method << ", " << batch;
            }
        }
    }
}

/// Half of the replicates are a half of the samples: of 5 samples even ones are the first, third and fifth.
TEST(Variances, StandBesideHalves) {
    const Image image = render(strips(5), with_aov(), "gpt").image;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < side; ++x) {
            const double even = pixel(image, x, y, "primal_even.G"), odd = pixel(image, x, y, "primal_odd.G");
            ASSERT_NEAR(pixel(image, x, y, "primal.G"), 0.6 * even + 0.4 * odd, 1e-6 * (even + odd));
            ASSERT_GT(pixel(image, x, y, "primal_odd_variance.G"), 0);
        }
}

} // namespace
} // namespace gradus::testing
