// The method `auto`: what it estimates, what it picks, and that its image is that of the method that it picked.
#include "driver/error_watch.h"
#include "planning/automatic_method.h"
#include "planning/make_method.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace gradus::testing {
namespace {

/// An image of gpt of one value: what it holds is `value` plus `noise` (standard deviation) where it is not
/// reconstructed, and plus `bias` and `left` (standard deviation) where it is.
Image synthetic(double value, double noise, double bias, double left, unsigned seed) {
    constexpr std::uint32_t side = 200;
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Image image;
    image.width = image.height = side;
    for (const char *color : {"R", "G", "B"}) {
        Channel reconstructed{color, {}}, primal{std::string("primal.").append(color), {}},
            direct{std::string("direct.").append(color), std::vector<float>(side * side, 0.25f)};
        for (std::uint32_t i = 0; i < side * side; ++i) {
            primal.values.push_back(float(value - 0.25 + noise * normal(random)));
            reconstructed.values.push_back(float(value + bias + left * normal(random)));
        }
        for (Channel *channel : {&reconstructed, &primal, &direct})
            image.channels.push_back(*channel);
    }
    return image;
}

/// 120,000 values: sums of squares are known to 1 / sqrt(60,000) = 0.4 %, the product that tells the bias to
/// noise^2 / sqrt(120,000). Four standard deviations are allowed.
TEST(PilotErrors, TellsVarianceAndBiasWithoutAReference) {
    const auto estimate = [](double bias, double left) {
        return estimate_errors(synthetic(1, 0.5, bias, left, 1), synthetic(1, 0.5, bias, left, 2));
    };
    const double product_deviation = 4 * 0.25 / std::sqrt(120000.0);
    // Relative to 1 + 0.001; where there is a bias, to the square of what it makes of 1.
    const PilotErrors unbiased = estimate(0, 0.05);
    EXPECT_NEAR(unbiased.pt, 0.25 / 1.001, 0.25 * 0.03);
    EXPECT_NEAR(unbiased.gpt, 0.0025 / 1.001, product_deviation);
    const PilotErrors biased = estimate(0.2, 0.05);
    EXPECT_NEAR(biased.gpt, (0.0025 + 0.04) / 1.441, product_deviation);
    const PilotErrors no_bias_left_out = estimate(0.2, 0);
    EXPECT_GT(no_bias_left_out.gpt, 0.02) << "both halves are wrong alike";
}

/// What relMSE weighs by is not the firefly itself: 100 where all else is 0.1.
TEST(PilotErrors, AFireflyIsNotItsOwnReference) {
    const Image second = synthetic(0.1, 0, 0, 0, 1);
    Image first = second;
    const std::size_t pixel = 200 * 57 + 31;
    for (Channel &channel : first.channels)
        if (channel.name == "R" || channel.name == "primal.R")
            channel.values[pixel] += 100;
    const PilotErrors errors = estimate_errors(first, second);
    const double expected = 0.5 * 100 * 100 / (0.01 + 0.001) / 120000; // of one value of 120,000
    EXPECT_NEAR(errors.pt / expected, 1, 1e-3) << "100.1 or 50.1 as reference give thousandths";
    EXPECT_NEAR(errors.gpt / expected, 1, 1e-3);
}

TEST(Pilot, OfHalvesIsATenthOfTheRenderAtMost) {
    for (const std::uint64_t samples : {std::uint64_t(0), std::uint64_t(1), 20 * half_samples - 1})
        EXPECT_FALSE(has_room_for_halves(samples)) << samples;
    EXPECT_TRUE(has_room_for_halves(20 * half_samples));
    EXPECT_TRUE(has_room_for_halves(std::uint64_t(1) << 40));
}

/// A sixty-fourth of the paths, in pairs of rows; none where launches would cost more than that.
TEST(RowPilot, IsAFewRowsOfTheImage) {
    for (const std::uint64_t samples : {std::uint64_t(0), std::uint64_t(1), std::uint64_t(32)})
        EXPECT_EQ(rows_of_pilot(128, 96, samples), 0u) << samples;
    EXPECT_EQ(rows_of_pilot(128, 96, 33), 8u);
    EXPECT_EQ(rows_of_pilot(128, 96, 120), 22u); // 1.47e6 / 64 / 8 / 128 is 22.5
    EXPECT_EQ(rows_of_pilot(1920, 1080, 1), 8u);
    EXPECT_EQ(rows_of_pilot(1920, 1080, std::uint64_t(1) << 40), 64u);
    EXPECT_EQ(rows_of_pilot(1920, 7, std::uint64_t(1) << 40), 6u);
    EXPECT_EQ(rows_of_pilot(1 << 20, 1, 1000), 0u) << "no pair of rows";
    EXPECT_EQ(rows_of_pilot(16, 16, 80, true), 8u);
}

/// As many paths as launches take, in pairs of rows.
TEST(RowPilot, OfARenderUntilATimeTellsItsSamples) {
    EXPECT_EQ(rows_of_timed_pilot(64, 64), 64u);
    EXPECT_EQ(rows_of_timed_pilot(256, 256), 24u); // 50,000 / 8 / 256 is 24.4
    EXPECT_EQ(rows_of_timed_pilot(1920, 1080), 8u);
    EXPECT_EQ(rows_of_timed_pilot(64, 7), 6u);
    EXPECT_EQ(rows_of_timed_pilot(64, 1), 0u);
    RowPilot pilot;
    pilot.seconds = 0.2; // 8 samples of a tenth of the image: a quarter of a second each
    EXPECT_EQ(samples_within(10, pilot, 24, 240), 40u);
    EXPECT_EQ(samples_within(0.01, pilot, 24, 240), 1u);
    pilot.seconds = 0;
    EXPECT_GT(samples_within(10, pilot, 24, 240), 1u << 30);
}

/// Means over frequencies, against sums of 256 x 256 of them. Frequencies that lie evenly tell the mean of a smooth
/// periodic function to rounding; the least width of its peak, 1 / sqrt(100), is twice the distance of the 64.
TEST(RowPilot, KnowsWhatLeastSquaresLeave) {
    const auto by_sum = [](double across, double down) {
        double sum = 0;
        constexpr int count = 256;
        for (int i = 0; i < count; ++i)
            for (int j = 0; j < count; ++j)
                sum += 1 / (1 + across * (2 - 2 * std::cos((i + 0.5) * M_PI / count)) +
                            down * (2 - 2 * std::cos((j + 0.5) * M_PI / count)));
        return sum / (count * count);
    };
    EXPECT_DOUBLE_EQ(part_left(0, 0), 1);
    for (const auto &[across, down] :
         {std::pair{1.0, 1.0}, {1.0, 0.0}, {0.0, 5.0}, {0.3, 20.0}, {20.0, 0.3}, {100.0, 100.0}})
        EXPECT_NEAR(part_left(across, down) / by_sum(across, down), 1, 1e-3) << across << " " << down;
    EXPECT_LT(part_left(1e8, 1e8), 1e-3);
}

RowPilot pilot_of(double error, double left, double pt_cost, double gpt_cost) {
    RowPilot pilot;
    pilot.error = error;
    pilot.left = left;
    pilot.costs = {pt_cost, gpt_cost};
    return pilot;
}

MethodChoice choice_for(const RowPilot &pilot, Reconstruction reconstruction = Reconstruction::weighted,
                        std::uint64_t samples = 10'000) {
    return choose_by_pilot(pilot, reconstruction, samples, 1'000'000);
}

TEST(ChoiceByPilot, IsOfLessErrorAtEqualCost) {
    const MethodChoice gpt = choice_for(pilot_of(4, 0.125, 5, 10)); // twice what variances say
    EXPECT_EQ(gpt.method, "gpt");
    EXPECT_NEAR(gpt.gain, 2, 0.01);
    EXPECT_DOUBLE_EQ(gpt.estimates.at("pt").relative_mse, 4);
    EXPECT_DOUBLE_EQ(gpt.estimates.at("gpt").relative_mse, 1);
    const MethodChoice pt = choice_for(pilot_of(4, 0.3125, 5, 10));
    EXPECT_EQ(pt.method, "pt");
    EXPECT_NEAR(pt.gain, 0.8, 0.01);
}

/// Solving costs 18 rays a pixel and 1.1 million, as much as gpt's samples where there are few.
TEST(ChoiceByPilot, CountsTheReconstruction) {
    const RowPilot pilot = pilot_of(4, 0.125, 5, 10);
    EXPECT_NEAR(choice_for(pilot, Reconstruction::weighted, 4).gain, 20 / (10 + (18 + 1.1) / 4), 1e-6);
    EXPECT_EQ(choose_by_pilot(pilot, Reconstruction::weighted, 4, 10'000).method, "pt");
}

/// One that ends by its error may have 2^20 samples, and one by time any number: neither comes near.
TEST(ChoiceByPilot, TakesRendersWithoutACountForOnesOf1024) {
    const RowPilot pilot = pilot_of(4, 0.1, 5, 12);
    const double of_1024 = choice_for(pilot, Reconstruction::guided, 1024).gain;
    for (const std::uint64_t samples : {ErrorWatch::most_samples, std::uint64_t(1) << 40})
        EXPECT_EQ(choice_for(pilot, Reconstruction::guided, samples).gain, of_1024) << samples;
    EXPECT_NE(choice_for(pilot, Reconstruction::guided, ErrorWatch::most_samples / 2).gain, of_1024);
}

/// What a guide does for pt is not gained by gpt once more.
TEST(ChoiceByPilot, GoesByTheReconstruction) {
    const RowPilot pilot = pilot_of(4, 0.1, 5, 12);
    const double weighted = choice_for(pilot).gain, guided = choice_for(pilot, Reconstruction::guided, 16).gain;
    EXPECT_GT(weighted, 1.5);
    EXPECT_LT(guided, 1);
    EXPECT_GT(choice_for(pilot, Reconstruction::guided, 1 << 20).gain, guided);
    EXPECT_NEAR(choice_for(pilot, Reconstruction::l1).gain * 1.3, weighted, 1e-6);
}

TEST(ChoiceByPilot, IsPtWhereThePilotTellsNothing) {
    const double infinity = std::numeric_limits<double>::infinity();
    for (const RowPilot &pilot : {pilot_of(0, 1, 5, 10), pilot_of(std::nan(""), 1, 5, 10), pilot_of(infinity, 1, 5, 10),
                                  pilot_of(1, std::nan(""), 5, 10), pilot_of(0, 0, 0, 0)}) {
        const MethodChoice choice = choice_for(pilot);
        EXPECT_EQ(choice.method, "pt");
        EXPECT_FALSE(choice.reason.empty());
        EXPECT_EQ(choice.gain, 0);
    }
}

/// The same with the layer `bias`, of this value and as noisy as the primal.
Image with_bias(Image image, double bias, double noise, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (const char *color : {"R", "G", "B"}) {
        Channel channel{std::string("bias.").append(color), {}};
        for (std::size_t i = 0; i < image.find("R")->values.size(); ++i)
            channel.values.push_back(float(bias + noise * normal(random)));
        image.channels.push_back(std::move(channel));
    }
    return image;
}

/// Paths see half of the light that photons see. Four standard deviations of a mean of 120,000 products, the larger of
/// which have one of about 0.5 * 0.3 + 0.2 * 0.2.
TEST(PhotonErrors, TellWhatPathsMissFromWhatTheRadiusAdds) {
    const auto estimate = [](double bias) {
        return estimate_photon_errors(with_bias(synthetic(1, 0.2, 0, 0.1, 1), bias, 0.2, 5),
                                      with_bias(synthetic(1, 0.2, 0, 0.1, 2), bias, 0.2, 6),
                                      synthetic(0.5, 0.2, 0, 0.1, 3), synthetic(0.5, 0.2, 0, 0.1, 4));
    };
    const double deviations = 4 * 0.2 / std::sqrt(120000.0);
    const PhotonErrors exact = estimate(0);
    EXPECT_NEAR(exact.missed, 0.25 / 1.001, 2 * deviations); // less three of the errors that it knows
    EXPECT_NEAR(exact.gpm_radius, 0, deviations);
    EXPECT_NEAR(exact.gpm, 0.01 / 1.001, deviations);
    EXPECT_NEAR(exact.pt, 0.04 / 1.001, deviations) << "relative to the brighter images";
    const PhotonErrors biased = estimate(0.5);
    EXPECT_NEAR(biased.gpm_radius, 0.25 / 1.001, 2 * deviations);
    EXPECT_LT(biased.missed, 2 * deviations);
}

/// gpt with errors of 0.08 a half pilot, which is 0.32 of one sample, and of 10 rays.
MethodChoice choice_of_gpt() {
    MethodChoice choice;
    choice.method = "gpt";
    choice.gain = 2;
    choice.estimates["gpt"] = {0.32, 10};
    return choice;
}

TEST(ChoiceByPhotons, IsOfLessThanHalfOfTheErrorAtEqualCost) {
    PhotonPilot pilot;
    pilot.cost = 40;
    pilot.light_paths = 1000;
    pilot.photons = 2000;
    pilot.errors.gpt = 0.08;
    pilot.errors.gpm = 0.03; // times 4, at equal cost: 0.12 of 0.32
    const auto choose = [&](std::uint64_t samples) { return choose_by_photons(choice_of_gpt(), pilot, samples, {}); };
    const PhotonChoice photons = choose(1600);
    EXPECT_EQ(photons.choice.method, "gpm");
    EXPECT_EQ(photons.light_paths, 25'000u) << "16,000 rays a pixel are 400 passes of the pilot, in 16 passes";
    EXPECT_EQ(photons.samples, 16u);
    const PhotonChoice longer = choose(160'000);
    EXPECT_EQ(longer.light_paths, 500'000u) << "those of a million photons";
    EXPECT_EQ(longer.samples, 80u);
    pilot.errors.gpm = 0.05;
    const PhotonChoice paths = choose(1600);
    EXPECT_EQ(paths.choice.method, "gpt");
    EXPECT_EQ(paths.samples, 1600u);
    EXPECT_EQ(paths.light_paths, 0u);
    EXPECT_EQ(paths.choice.gain, 2);
    // What paths miss stays, and so does the bias by the radius.
    pilot.errors.missed = 0.1;
    EXPECT_EQ(choose(1600).choice.method, "gpm");
    EXPECT_THAT(choose(1600).choice.reason, ::testing::HasSubstr("misses light"));
    pilot.errors.gpm_radius = 0.06;
    EXPECT_EQ(choose(1600).choice.method, "gpt");
    pilot.errors.missed = std::nan("");
    EXPECT_EQ(choose(1600).choice.method, "gpt");
}

/// Where nearly all photons of the pilot are seen, the usual pass is smaller than the pilot's, and it counts.
TEST(ChoiceByPhotons, HasNoLargerPassThanUsual) {
    PhotonPilot pilot;
    pilot.cost = 40;
    pilot.light_paths = 1000;
    pilot.photons = 8'000'000;
    pilot.errors.gpt = 0.08;
    pilot.errors.gpm = 0.03;
    const PhotonChoice photons = choose_by_photons(choice_of_gpt(), pilot, 1600, {});
    EXPECT_EQ(photons.choice.method, "gpm");
    EXPECT_EQ(photons.light_paths, 125u) << "those of a million photons";
}

/// Pairs of rows bear what they do in the whole image, for every batch size, but for differences down to the next pair.
/// Without roulette, for offset paths have a part in it. The sums of a base path are rounded by when its offset paths
/// join it: some tens of roundings, 2e-6 of the largest value.
TEST(RowPilot, RendersRowsOfTheImage) {
    constexpr std::uint32_t width = 40, height = 30, count = 8;
    Scene scene = own_scene("cornell-box.xml", width, height);
    scene.settings.samples_per_pixel = 4;
    scene.settings.rr_depth = -1;
    scene.settings.max_depth = 5;
    GradientPathTracer whole(shared_device(), scene, {});
    while (whole.render_batch()) {
    }
    const Image image = whole.image_with_layers();
    for (const std::uint32_t batch : {0u, 200u}) {
        RenderOptions options;
        options.batch_size = batch;
        GradientPathTracer method(shared_device(), scene, options);
        const GradientPathTracer::Rows rows = method.render_rows(count, 0, 4);
        EXPECT_EQ(rows.image.height, count);
        std::vector<float> plane(width * count);
        for (const auto &[name, layer] :
             {std::pair{"primal.G", GradientFilm::primal}, {"dx.G", GradientFilm::dx}, {"dy.G", GradientFilm::dy}}) {
            rows.films.mean(layer)(1, plane.data());
            const std::vector<float> &expected = image.find(name)->values;
            constexpr float rounding = 2e-6f;
            const float largest = *std::max_element(expected.begin(), expected.end());
            for (std::uint32_t row = 0; row < count; ++row) {
                const std::uint32_t y = (row / 2 * 2 + 1) * height / count - 1 + row % 2;
                for (std::uint32_t x = 0; x < width && !(layer == GradientFilm::dy && row % 2 == 1); ++x)
                    ASSERT_NEAR(plane[row * width + x], expected[y * width + x], rounding * largest)
                        << name << " " << x << " " << y;
            }
        }
        // And the method renders the whole as ever.
        method.restart(0, 4);
        while (method.render_batch()) {
        }
        EXPECT_TRUE(equal_bits(method.image_with_layers(), image)) << batch;
    }
}

/// Its pairs of rows lie far apart: what of one would count for the next is of another place. So it tells the noise of
/// samples by themselves, whichever the filter: a Gaussian would leave a third of it.
TEST(Pilot, OfRowsKnowsNoFilter) {
    const auto error_with = [](FilmSettings::Filter filter, float radius) {
        Scene scene = own_scene("cornell-box.xml", 64, 64);
        scene.film.filter = filter;
        scene.film.filter_radius = radius;
        scene.settings.samples_per_pixel = pilot_samples;
        GradientPathTracer method(shared_device(), scene, RenderOptions());
        return run_row_pilot(method, 32).error;
    };
    const double box = error_with(FilmSettings::Filter::box, 0.5f);
    EXPECT_NEAR(error_with(FilmSettings::Filter::gaussian, 2) / box, 1, 0.25);
    EXPECT_NEAR(error_with(FilmSettings::Filter::lanczos, 3) / box, 1, 0.25);
}

/// Samples of a pilot have numbers of their own: what is as bright everywhere is so in its image, too.
TEST(Pilot, IsAsBrightAsTheImage) {
    for (const auto filter : {FilmSettings::Filter::lanczos, FilmSettings::Filter::mitchell})
        for (const std::uint64_t seed : {0, 1, 3}) {
            SceneMaker maker(8, 4);
            maker.look({0, 0, 3}, {0, 0, 0}, 40);
            maker.environment(0.5);
            maker.scene.film.filter = filter;
            maker.scene.film.filter_radius = filter == FilmSettings::Filter::lanczos ? 3 : 2;
            RenderOptions options;
            options.seed = seed;
            GradientPathTracer method(shared_device(), maker.scene, options);
            for (const std::uint64_t first :
                 {std::uint64_t(1) << 62, (std::uint64_t(1) << 62) + (std::uint64_t(1) << 32)}) {
                method.restart(first, 4);
                while (method.render_batch()) {
                }
                EXPECT_NEAR(method.mean_image().find("G")->values[0], 0.5, 1e-5) << seed << " from " << first;
            }
        }
}

/// The image is that of the method, for every batch size and number of threads, and so are the estimates.
void expect_choice(const Scene &scene, const std::string &method) {
    RenderOptions options;
    options.seed = 5;
    const Rendered automatic = render(scene, options, "auto");
    ASSERT_TRUE(automatic.statistics.choice);
    const MethodChoice &choice = *automatic.statistics.choice;
    EXPECT_EQ(choice.method, method) << choice.reason << ", gain " << choice.gain;
    EXPECT_GT(choice.gain, 0);
    EXPECT_EQ(choice.pilot_samples, pilot_samples);
    EXPECT_EQ(automatic.statistics.samples, scene.settings.samples_per_pixel * scene.film.width * scene.film.height)
        << "the pilot's samples are not the render's";
    EXPECT_TRUE(equal_bits(automatic.image, render(scene, options, method.c_str()).image));
    options.batch_size = 10'000;
    options.threads = 1;
    const Rendered again = render(scene, options, "auto");
    EXPECT_TRUE(equal_bits(automatic.image, again.image));
    EXPECT_EQ(choice.gain, again.statistics.choice->gain);
    EXPECT_EQ(choice.reason, again.statistics.choice->reason);
    for (const char *name : {"pt", "gpt"}) {
        EXPECT_EQ(choice.estimates.at(name).relative_mse, again.statistics.choice->estimates.at(name).relative_mse);
        EXPECT_EQ(choice.estimates.at(name).cost, again.statistics.choice->estimates.at(name).cost);
    }
}

TEST(Automatic, TakesGptInTheCornellBox) {
    Scene scene = own_scene("cornell-box.xml", 48, 40);
    scene.settings.samples_per_pixel = 210;
    expect_choice(scene, "gpt");
}

/// The pilot looks at layers that an image does not have unless they are asked for. And the last image, for which the
/// method lets go of its memory, is like all others.
TEST(Automatic, HasNoLayersThatNobodyAskedFor) {
    Scene scene = own_scene("cornell-box.xml", 48, 40);
    scene.settings.samples_per_pixel = 210;
    const std::unique_ptr<Method> method = make_method("auto", shared_device(), scene, {});
    while (method->render_batch()) {
    }
    const Image image = method->image();
    EXPECT_EQ(image.channels.size(), 3u);
    EXPECT_TRUE(equal_bits(image, method->last_image()));
    const Image with_layers = render(scene, {}, "gpt").image;
    for (const Channel &channel : image.channels)
        EXPECT_EQ(channel.values, with_layers.find(channel.name)->values) << channel.name;
}

/// Spheres no larger than a pixel, of all colours: neighbouring pixels have nothing in common, and shifts seldom
/// connect.
TEST(Automatic, TakesPtWhereNeighboursHaveNothingInCommon) {
    SceneMaker maker(32, 400);
    maker.look({0, 0, 4}, {0, 0, 0}, 30);
    maker.environment(1);
    maker.scene.settings.max_depth = 4;
    std::mt19937 random(1);
    const auto unit = [&random] { return float(random() >> 8) / float(1 << 24); };
    std::vector<std::uint32_t> materials;
    for (int i = 0; i < 16; ++i) {
        Bsdf bsdf = diffuse(0);
        bsdf.reflectance = {unit(), unit(), unit()};
        materials.push_back(maker.material(bsdf));
    }
    for (int i = 0; i < 4000; ++i)
        maker.sphere({2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1}, 0.03f, materials[random() % materials.size()]);
    expect_choice(maker.scene, "pt");
}

/// A floor lit by a lamp in a ball of glass alone: of some size paths find it seldom, a point never.
Scene lamp_in_glass(bool is_point) {
    SceneMaker maker(24, 400);
    maker.look({0, 3, 3}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 8;
    maker.floor(-1, 1, 1, maker.material(diffuse(0.7)));
    maker.sphere({0, 1.5f, 0}, 0.3f, maker.material(glass(1.5)));
    if (is_point)
        maker.point_light({5, 5, 5}, {0.05f, 1.5f, 0});
    else
        maker.sphere({0.05f, 1.5f, 0}, 0.02f, maker.material(diffuse(0)),
                     maker.emitter(Emitter::Kind::area, {4000, 4000, 4000}));
    maker.scene.settings.hide_emitters = true;
    return maker.scene;
}

TEST(FullAutomatic, TakesGpmWhereLightComesThroughGlass) {
    for (const bool is_point : {false, true}) {
        const Scene scene = lamp_in_glass(is_point);
        RenderOptions options;
        options.seed = 3;
        const Rendered automatic = render(scene, options, "auto");
        const MethodChoice &choice = automatic.statistics.choice.value();
        ASSERT_EQ(choice.method, "gpm") << choice.reason;

        EXPECT_EQ(choice.estimates.count("gpm"), 1u);
        const std::uint64_t passes = automatic.statistics.samples / (24 * 24);
        Scene same = scene;
        same.settings.samples_per_pixel = passes;
        options.photons = automatic.statistics.light_paths / passes;
        EXPECT_TRUE(equal_bits(automatic.image, render(same, options, "gpm").image));
    }
}

/// A render until a time asks for photons where there is time for it, and goes on until then whatever it picked.
TEST(Automatic, HasTimeForAPilot) {
    Scene scene = lamp_in_glass(true);
    scene.settings.samples_per_pixel = std::uint64_t(1) << 30;
    const auto prepared = [&](double seconds) {
        RenderOptions options;
        options.time_limit = seconds;
        const std::unique_ptr<Method> method = make_method("auto", shared_device(), scene, options);
        EXPECT_GT(method->total_samples(), std::uint64_t(24 * 24) << 20) << seconds;
        return method->statistics().choice.value();
    };
    prepared(1e-4); // whose first launches are slow, and so would count as its pilot's
    const MethodChoice hasty = prepared(1e-4), patient = prepared(60);
    EXPECT_EQ(hasty.estimates.count("gpm"), 0u);
    EXPECT_EQ(hasty.pilot_samples, pilot_samples);
    EXPECT_EQ(patient.estimates.count("gpm"), 1u);
    EXPECT_EQ(patient.method, "gpm") << patient.reason;
    EXPECT_LT(hasty.pilot_seconds, patient.pilot_seconds);
}

/// Glass is there, and what lights the floor does not come through it.
TEST(FullAutomatic, LeavesPhotonsWherePathsFindAll) {
    SceneMaker maker(24, 96);
    maker.look({0, 3, 3}, {0, 0, 0}, 30);
    maker.scene.settings.max_depth = 8;
    maker.floor(-1, 1, 1, maker.material(diffuse(0.7)));
    maker.sphere({5, 0.5f, 0}, 0.4f, maker.material(glass(1.5)));
    maker.environment(1);
    const MethodChoice choice = render(maker.scene, {}, "auto").statistics.choice.value();
    EXPECT_NE(choice.method, "gpm") << choice.reason;
    EXPECT_EQ(choice.estimates.count("gpm"), 1u);
}

TEST(Automatic, TakesPtForABlackImage) {
    SceneMaker maker(16, 1600);
    maker.look({0, 0, 4}, {0, 0, 0}, 30);
    maker.environment(0);
    maker.sphere({0, 0, 0}, 1, maker.material(diffuse(0.5)));
    const Rendered rendered = render(maker.scene, {}, "auto");
    EXPECT_EQ(rendered.statistics.choice->method, "pt");
    EXPECT_THAT(rendered.statistics.choice->reason, ::testing::HasSubstr("no noise"));
    EXPECT_EQ(spread_of(rendered.image).most, 0);
}

TEST(Automatic, GoesByARuleWhereThereIsNoRoomForAPilot) {
    Scene scene = own_scene("cornell-box.xml", 48, 40);
    struct Case {
        std::uint64_t samples;
        int max_depth;
        const char *method;
    };
    for (const auto &[samples, max_depth, method] : {Case{16, -1, "gpt"}, {16, 1, "pt"}, {1, -1, "pt"}}) {
        scene.settings.samples_per_pixel = samples;
        scene.settings.max_depth = max_depth;
        const Rendered rendered = render(scene, {}, "auto");
        ASSERT_TRUE(rendered.statistics.choice);
        EXPECT_EQ(rendered.statistics.choice->method, method);
        EXPECT_EQ(rendered.statistics.choice->pilot_samples, 0u);
        EXPECT_TRUE(rendered.statistics.choice->estimates.empty());
        EXPECT_TRUE(equal_bits(rendered.image, render(scene, {}, method).image));
    }
}

TEST(Automatic, SaysWhyThereIsNoPilot) {
    struct Case {
        std::uint32_t width, height;
        const char *reason;
    };
    for (const auto &[width, height, reason] :
         {Case{16, 12, "the render is too short"}, {1, 500, "one row or column of pixels"}, {500, 1, "one row"}}) {
        Scene scene = own_scene("cornell-box.xml", width, height);
        scene.settings.samples_per_pixel = 1'000'000;
        if (width > 1 && height > 1)
            scene.settings.samples_per_pixel = 16;
        const auto method = make_method("auto", shared_device(), scene, {});
        const Statistics statistics = method->statistics();
        ASSERT_TRUE(statistics.choice);
        EXPECT_EQ(statistics.choice->pilot_samples, 0u);
        EXPECT_THAT(statistics.choice->reason, ::testing::HasSubstr(reason));
        EXPECT_NE(method->tracer(), nullptr) << "that of the method that it took";
    }
}

TEST(Automatic, TakesPtForAShortRenderOfSharpShadows) {
    SceneMaker maker(48, 40);
    maker.look({0, 3, 8}, {0, 0, 0}, 45);
    maker.floor(-4, 4, 0, maker.material(diffuse(0.5)));
    maker.sphere({0, 1, 0}, 1, maker.material(diffuse(0.5)));
    maker.scene.settings.samples_per_pixel = 16;
    SceneMaker of_lamp = maker;
    maker.point_light({30, 30, 30}, {2, 5, 3});
    of_lamp.lamp({2, 5, 3}, 1, 1, 30, of_lamp.material(diffuse(0)));
    EXPECT_EQ(render(maker.scene, {}, "auto").statistics.choice->method, "pt");
    EXPECT_EQ(render(of_lamp.scene, {}, "auto").statistics.choice->method, "gpt");
}

} // namespace
} // namespace gradus::testing
