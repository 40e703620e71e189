// The layer `error`: what is made of squared errors by pixel, and of renders.
#include "methods/error_layer.h"
#include "runtime/error.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"

#include <gmock/gmock.h>

#include <array>
#include <numbers>
#include <random>

namespace gradus::testing {
namespace {

constexpr std::uint32_t side = 64;

Image plain_image(float value) {
    return image_of(side, side, [value](int, std::uint32_t, std::uint32_t) { return value; });
}

/// R, G and B alone.
Image select_colors(Image image) {
    image.channels.resize(3);
    return image;
}

SquaredErrors known_errors(float variance) {
    SquaredErrors errors;
    errors.variance.assign(3 * side * side, variance);
    return errors;
}

TEST(ErrorLayer, IsTheRootOfWhatIsKnown) {
    Image image = plain_image(2);
    const std::optional<double> relative = add_error_layer(image, known_errors(0.09f));
    ASSERT_TRUE(relative);
    EXPECT_NEAR(*relative, 0.09 / 4.001, 1e-6);
    for (const char *color : colors)
        for (const float error : image.find(std::string("error.") + color)->values)
            ASSERT_NEAR(error, 0.3f, 1e-6f);
}

/// Single values are squares of normal numbers. A mean over 25 neighbours, so many a Gaussian of two pixels counts as
/// half of, is their variance to 2 / sqrt(50) on one standard deviation.
TEST(ErrorLayer, IsAMeanOverNeighbours) {
    std::mt19937 generator(1);
    std::normal_distribution<float> normal;
    SquaredErrors errors = known_errors(0);
    for (std::size_t i = 0; i < errors.variance.size(); ++i)
        errors.variance[i] = std::pow((i % side < side / 2 ? 0.1f : 1.0f) * normal(generator), 2.0f);
    Image image = plain_image(1);
    add_error_layer(image, errors);
    double left = 0, right = 0;
    for (std::uint32_t y = 0; y < side; ++y)
        for (std::uint32_t x = 0; x < 20; ++x) {
            const double l = pixel(image, x, y, "error.G"), r = pixel(image, side - 1 - x, y, "error.G");
            EXPECT_NEAR(l, 0.1, 0.07);
            EXPECT_NEAR(r, 1, 0.7);
            left += l * l / (20 * side);
            right += r * r / (20 * side);
        }
    EXPECT_NEAR(left, 0.01, 0.002);
    EXPECT_NEAR(right, 1, 0.2);
}

/// Means over neighbours of a Gaussian of 6 pixels have the standard error of 4 pi 36 values, a 21st of one's.
TEST(ErrorLayer, ABiasThatIsNotSeenCountsAsOneStandardError) {
    std::mt19937 generator(2);
    std::normal_distribution<float> normal;
    SquaredErrors errors = known_errors(0.01f);
    for (std::size_t i = 0; i < errors.variance.size(); ++i)
        errors.bias.push_back(0.1f * normal(generator) - 0.03f);
    Image image = plain_image(1);
    const double error = 0.104 / std::sqrt(4 * std::numbers::pi * 36);
    const double relative = *add_error_layer(image, errors);
    EXPECT_GT(relative, (0.01 + error) / 1.001);
    EXPECT_LT(relative, (0.01 + 1.3 * error) / 1.001) << "at the border neighbours are fewer";
    EXPECT_NEAR(pixel(image, side / 2, side / 2, "error.R"), std::sqrt(0.01 + error), 0.003);
    errors.bias.assign(errors.bias.size(), 0.03f);
    image = plain_image(1);
    EXPECT_NEAR(*add_error_layer(image, errors), 0.04 / 1.001, 0.0001);
    EXPECT_NEAR(pixel(image, 5, 5, "error.R"), 0.2, 1e-5);
}

/// What is bright does not make what is dark beside it wrong.
TEST(ErrorLayer, BiasIsRelative) {
    Image image = image_of(side, side, [](int, std::uint32_t x, std::uint32_t) { return x < side / 2 ? 0.1 : 10.0; });
    SquaredErrors errors = known_errors(0);
    for (std::size_t i = 0; i < errors.variance.size(); ++i)
        errors.bias.push_back(i % side < side / 2 ? 0.0001f : 1.0f);
    add_error_layer(image, errors);
    for (std::uint32_t x = 0; x < side; ++x)
        EXPECT_NEAR(pixel(image, x, 9, "error.B") / pixel(image, x, 9, "B"), 0.1, 0.006) << x;
}

/// A firefly counts in full where its neighbours are dark.
TEST(ErrorLayer, AFireflyIsNoReferenceOfItsOwn) {
    Image image = plain_image(0.1f);
    image.channels[0].values[10 * side + 10] = 100;
    SquaredErrors errors = known_errors(0);
    errors.variance[10 * side + 10] = 10000;
    EXPECT_NEAR(*add_error_layer(image, errors), 10000 / (0.01 + 0.001) / (3 * side * side), 1);
}

TEST(ErrorLayer, WhatIsNotFiniteIsTakenFromNeighbours) {
    SquaredErrors errors = known_errors(0.04f);
    errors.variance[7 * side + 7] = NAN;
    errors.variance[side * side] = INFINITY;
    Image image = plain_image(1);
    image.channels[2].values[9] = NAN;
    EXPECT_NEAR(*add_error_layer(image, errors), 0.04 / 1.001, 1e-6);
    EXPECT_NEAR(pixel(image, 7, 7, "error.R"), 0.2, 1e-6);
    EXPECT_NEAR(pixel(image, 0, 0, "error.G"), 0.2, 1e-6);
    errors.variance.assign(errors.variance.size(), NAN);
    image = plain_image(1);
    EXPECT_FALSE(add_error_layer(image, errors));
    for (const char *color : colors)
        for (const float error : image.find(std::string("error.") + color)->values)
            ASSERT_EQ(error, 0);
}

struct RenderedErrors {
    const char *method;
    Reconstruction reconstruction;
    double least, most; ///< estimated relMSE over the true one
};
void PrintTo(const RenderedErrors &c, std::ostream *out) {
    *out << c.method << " " << reconstruction_name(c.reconstruction);
}

class ErrorOfRenders : public ::testing::TestWithParam<RenderedErrors> {
  protected:
    static Scene scene_of(std::uint64_t samples) {
        Scene scene = own_scene("cornell-box.xml", 64, 48);
        scene.settings.samples_per_pixel = samples;
        return scene;
    }
    static RenderOptions options_of(std::uint64_t seed) {
        RenderOptions options;
        options.seed = seed;
        options.reconstruction = GetParam().reconstruction;
        options.error = true;
        return options;
    }
};

/// Of 16 samples, against 1024 of another seed. Of two renders whose error all pixels share in part, the places within
/// the pixel. What guides are wrong by is known within a factor of two or three (error_layer.h).
TEST_P(ErrorOfRenders, IsNearTheTruth) {
    static const Image truth = [] {
        RenderOptions options;
        options.seed = 100;
        return render(scene_of(1024), options, "pt").image;
    }();
    constexpr int seeds = 2;
    double told = 0, right = 0;
    std::size_t within = 0, values = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
        const Rendered rendered = render(scene_of(16), options_of(seed), GetParam().method);
        ASSERT_TRUE(rendered.statistics.estimated_error);
        told += *rendered.statistics.estimated_error / seeds;
        right += relative_mse(rendered.image, truth) / seeds;
        for (const char *color : colors) {
            const std::vector<float> &error = rendered.image.find(std::string("error.") + color)->values;
            for (std::size_t i = 0; i < error.size(); ++i)
                within += std::fabs(rendered.image.find(color)->values[i] - truth.find(color)->values[i]) < error[i];
            values += error.size();
        }
    }
    std::printf("relMSE %.5f, told %.5f; %.3f of the errors within the layer\n", right, told,
                double(within) / double(values));
    EXPECT_GT(told / right, GetParam().least);
    EXPECT_LT(told / right, GetParam().most);
    EXPECT_NEAR(double(within) / double(values), 0.68, 0.12);
}

/// The same bits for any batch, and with a pause where the samples so far make the image of a render of so many.
TEST_P(ErrorOfRenders, DoesNotDependOnBatchesNorOnPauses) {
    const Image straight = render(scene_of(7), options_of(3), GetParam().method).image,
                of_4 = render(scene_of(4), options_of(3), GetParam().method).image;
    EXPECT_NE(straight.find("error.R"), nullptr);
    for (const std::uint32_t batch : {0u, 1000u}) {
        RenderOptions options = options_of(3);
        options.layers = true;
        options.batch_size = batch;
        const auto method = make_method(GetParam().method, shared_device(), scene_of(7), options);
        method->pause_at(4 * 64 * 48);
        while (method->done_samples() < 4 * 64 * 48)
            ASSERT_TRUE(method->render_batch());
        ASSERT_EQ(method->done_samples(), 4u * 64 * 48);
        EXPECT_TRUE(equal_bits(method->image(), of_4)) << batch;
        while (method->render_batch()) {
        }
        EXPECT_TRUE(equal_bits(method->image(), straight)) << batch;
    }
}

INSTANTIATE_TEST_SUITE_P(Reconstructions, ErrorOfRenders,
                         ::testing::Values(RenderedErrors{"pt", Reconstruction::l1, 0.8, 1.2},
                                           RenderedErrors{"gpt", Reconstruction::l1, 0.6, 1.3},
                                           RenderedErrors{"gpt", Reconstruction::l2, 0.7, 1.3},
                                           RenderedErrors{"gpt", Reconstruction::weighted, 0.6, 1.3},
                                           RenderedErrors{"gpt", Reconstruction::guided, 0.4, 2.5},
                                           RenderedErrors{"pt", Reconstruction::guided, 0.4, 2.5}));

/// relMSE as so many seeds tell it, and as it is.
struct MeanErrors {
    double told = 0, right = 0;
};
MeanErrors mean_errors(const Scene &scene, const char *method, int seeds, const Scene &of_truth) {
    RenderOptions options;
    options.seed = 100;
    const Image truth = render(of_truth, options, "pt").image;
    MeanErrors errors;
    options.error = true;
    for (options.seed = 1; options.seed <= std::uint64_t(seeds); ++options.seed) {
        const Rendered rendered = render(scene, options, method);
        errors.told += rendered.statistics.estimated_error.value() / seeds;
        errors.right += relative_mse(rendered.image, truth) / seeds;
    }
    return errors;
}

/// With a filter all pixels share their places, so that the halves of one sequence of places would differ by twice the
/// error and more at a lamp whose sides lie like the film's.
TEST(ErrorLayer, OfPathTracingKnowsOfPlacesThatAllPixelsShare) {
    const auto scene = [](std::uint64_t samples) {
        SceneMaker maker(32, samples);
        maker.scene.settings.max_depth = 1;
        maker.look({0, 0, -1}, {0, 0, 0}, 90); // the film is 2 wide at z = 0
        maker.environment(1);
        const std::int32_t lamp = maker.emitter(Emitter::Kind::area, {5, 5, 5});
        maker.parallelogram({-0.53f, -0.47f, 0}, {0, 1.07f, 0}, {0.91f, 0, 0}, maker.material(diffuse(0.5)), lamp);
        maker.scene.film.filter = FilmSettings::Filter::gaussian;
        maker.scene.film.filter_radius = 2;
        return maker.scene;
    };
    const auto [told, right] = mean_errors(scene(32), "pt", 16, scene(1 << 14));
    std::printf("relMSE %.3g, told %.3g\n", right, told);
    EXPECT_GT(told / right, 0.6);
    EXPECT_LT(told / right, 1.7);
}

/// Nothing but lamps that are seen: few, whose edges gpt samples anew, and so many that it does not.
TEST(ErrorLayer, KnowsOfTheLightsThatAreSeen) {
    for (const int lamps : {8, 200}) {
        const auto scene = [&](std::uint64_t samples) {
            SceneMaker maker(48, samples);
            maker.scene.settings.max_depth = 1;
            maker.look({0, 0, 3}, {0, 0, 0}, 40);
            maker.environment(1); // in the dark a lamp that all samples missed would be most of relMSE
            const std::uint32_t black = maker.material(diffuse(0));
            std::mt19937 generator(7);
            std::uniform_real_distribution<float> place(-1, 1);
            for (int i = 0; i < lamps; ++i) {
                const float x = place(generator), y = place(generator);
                maker.sphere({x, y, 0}, 0.04f, black, maker.emitter(Emitter::Kind::area, {5, 5, 5}));
            }
            return maker.scene;
        };
        const auto [told, right] = mean_errors(scene(16), "gpt", 3, scene(1024));
        std::printf("%d lamps: relMSE %.5f, told %.5f\n", lamps, right, told);
        EXPECT_GT(told / right, 0.7);
        EXPECT_LT(told / right, 4); // halves of one sequence of places differ by more than it is wrong
    }
}

/// A render of a grey wall where one sample in two hundred is thirty times as bright: the image's mean after 16 and 32
/// samples a pixel, and the estimate at 16.
struct SkewedRender {
    double of_16, of_32, estimate;
};
SkewedRender skewed_render(std::mt19937 &generator) {
    constexpr std::uint32_t across = 16;
    std::binomial_distribution<int> bright_of_8(8, 0.005), bright_of_16(16, 0.005);
    constexpr double brighter = 30;
    Image image = image_of(across, across, [](int, std::uint32_t, std::uint32_t) { return 0.0; });
    std::array<std::vector<float>, 2> halves{std::vector<float>(3 * across * across), halves[0]};
    SkewedRender render{};
    for (std::size_t i = 0; i < across * across; ++i) {
        const auto of_half = [&] { return 1 + brighter * bright_of_8(generator) / 8; };
        const double first = of_half(), second = of_half(), later = 1 + brighter * bright_of_16(generator) / 16;
        for (std::size_t c = 0; c < 3; ++c) {
            halves[0][c * across * across + i] = float(first);
            halves[1][c * across * across + i] = float(second);
            image.channels[c].values[i] = float((first + second) / 2);
        }
        render.of_16 += (first + second) / 2 / (across * across);
        render.of_32 += ((first + second) / 4 + later / 2) / (across * across);
    }
    render.estimate = add_error_layer(image, errors_of_halves(halves[0], halves[1], 0.5)).value();
    return render;
}

/// What ending by the error does to the mean of many renders, in standard deviations of one's mean at 16 samples: each
/// ends there where the estimate is below that of half of the renders, which is where it does most, and else at 32.
struct Darkening {
    double shift, standard_error;
};
Darkening darkening_of(const std::vector<SkewedRender> &renders) {
    std::vector<double> estimates, means, changes;
    for (const SkewedRender &render : renders) {
        estimates.push_back(render.estimate);
        means.push_back(render.of_16);
    }
    const auto middle = estimates.begin() + std::ptrdiff_t(estimates.size() / 2);
    std::nth_element(estimates.begin(), middle, estimates.end());
    // Both means share most of their noise, so that the difference is seen well.
    for (const SkewedRender &render : renders)
        changes.push_back(render.estimate <= *middle ? render.of_16 - render.of_32 : 0.0);
    const double deviation = spread_of(means).standard_error * std::sqrt(double(renders.size()));
    return {spread_of(changes).mean / deviation, spread_of(changes).standard_error / deviation};
}

/// A quarter is the bound that holds for any noise (driver/error_watch.h).
TEST(ErrorLayer, EndingByItDarkensByLessThanAQuarterOfAStandardError) {
    std::mt19937 generator(3);
    std::vector<SkewedRender> renders;
    for (int i = 0; i < 2500; ++i)
        renders.push_back(skewed_render(generator));
    const Darkening dark = darkening_of(renders);
    EXPECT_LT(dark.shift, -4 * dark.standard_error) << "the test cannot see it";
    record_stability(
        {"Reconstruction", "a render that ends by its own estimated error ends sooner where rare light was missed",
         "2500 renders, one sample in two hundred thirty times as bright as the others, half of them end at 16 "
         "samples, the others at 32",
         "estimates are means over all pixels, and looks are few: the mean is low by less than a quarter of "
         "what chance moves it by in one render",
         "what the mean of many renders is low by, and four standard errors, in standard errors of one render's",
         std::fabs(dark.shift) + 4 * dark.standard_error, 0.25});
}

/// The same of renders.
class ErrorStop : public ::testing::TestWithParam<const char *> {};

TEST_P(ErrorStop, DarkensTheMeanByLessThanAQuarterOfItsStandardError) {
    constexpr std::uint32_t width = 32, height = 24;
    constexpr std::uint64_t pixels = width * height, seeds = 400;
    Scene scene = own_scene(std::string(GetParam()) + ".xml", width, height);
    scene.settings.samples_per_pixel = 32;
    std::vector<SkewedRender> renders;
    const auto mean_of = [](const Image &image) { return compare_means(image, image).image; };
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        RenderOptions options;
        options.seed = seed;
        options.error = true;
        const auto method = make_method("pt", shared_device(), scene, options);
        method->pause_at(16 * pixels);
        while (method->done_samples() < 16 * pixels)
            method->render_batch();
        renders.push_back({mean_of(select_colors(method->image())), 0, 0});
        renders.back().estimate = method->statistics().estimated_error.value();
        while (method->render_batch()) {
        }
        renders.back().of_32 = mean_of(select_colors(method->image()));
    }
    const Darkening dark = darkening_of(renders);
    std::printf("%s: the mean changes by %.3f +- %.3f standard errors of one render's\n", GetParam(), dark.shift,
                dark.standard_error);
    EXPECT_LE(std::fabs(dark.shift), 0.25 + 4 * dark.standard_error);
}

INSTANTIATE_TEST_SUITE_P(Full, ErrorStop, ::testing::Values("materials", "door-ajar", "cornell-box"));

TEST(ErrorLayer, IsWhereItIsAskedForAndHalvesAre) {
    struct Case {
        const char *method;
        std::uint64_t samples;
        Reconstruction reconstruction;
        bool aov, error, expected;
    };
    Scene scene = own_scene("cornell-box.xml", 24, 24);
    for (const Case &c :
         {Case{"pt", 4, Reconstruction::weighted, true, false, false},
          Case{"pt", 4, Reconstruction::guided, true, false, true},
          Case{"pt", 1, Reconstruction::l1, false, true, false}, Case{"gpt", 4, Reconstruction::l1, true, false, false},
          Case{"gpt", 4, Reconstruction::weighted, true, false, true},
          Case{"gpt", 1, Reconstruction::l1, false, true, false},
          Case{"gpt", 2, Reconstruction::l1, false, true, true}}) {
        scene.settings.samples_per_pixel = c.samples;
        RenderOptions options;
        options.reconstruction = c.reconstruction;
        options.aov = c.aov;
        options.error = c.error;
        const Rendered rendered = render(scene, options, c.method);
        EXPECT_EQ(rendered.image.find("error.B") != nullptr, c.expected)
            << c.method << c.samples << reconstruction_name(c.reconstruction) << c.aov << c.error;
        EXPECT_EQ(rendered.statistics.estimated_error.has_value(), c.expected);
    }
}

TEST(ErrorLayer, IsNotOfPhotonMethods) {
    const Scene scene = own_scene("cornell-box.xml", 16, 16);
    RenderOptions options;
    options.error = true;
    for (const char *method : {"sppm", "gpm"})
        try {
            make_method(method, shared_device(), scene, options);
            FAIL() << method;
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::usage);
            EXPECT_THAT(error.what(), ::testing::HasSubstr(method));
        }
}

} // namespace
} // namespace gradus::testing
