// The film: sums that lose nothing, samples that are not finite, and which pixel gets which sample.
#include "runtime/wavefront/film.h"

#include "runtime/error.h"
#include "runtime/film/replicates.h"
#include "runtime/wavefront/sample_parts.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/shared/tables.h"

namespace gradus {
namespace {

using namespace lib_float;

class FilmTest : public ::testing::Test {
  protected:
    Device device;
};

/// A film with the radiance of its samples, their features, and nothing that renders them.
struct FilmUnderTest {
    using Sampler = SessionOptions::Sampler;
    FilmUnderTest(Device &device, std::uint32_t slots, std::uint32_t width, std::uint32_t height, bool aov,
                  Sampler sampler = Sampler::independent)
        : FilmUnderTest(device, slots, scene_of(width, height), options_with(aov, sampler), false) {}
    /// `halves`: even and odd samples apart.
    FilmUnderTest(Device &device, std::uint32_t slots, const Scene &scene, const SessionOptions &options, bool halves)
        : session(device, scene, options, {{"TRAIT_PART_BITS", part_bits(options, halves)}}),
          film(session, stages, halves),
          tables(device, film.tables(), {64, slots, session.pixels(), scene.film.width, 1}, Precision::single) {
        session.numbers["slots"] = slots;
        stages.build(session, tables);
        film.attach(tables);
    }
    static Scene scene_of(std::uint32_t width, std::uint32_t height) {
        testing::SceneMaker maker(width, 1);
        maker.floor(-1, 1, 1, maker.material(testing::diffuse(0.5)));
        maker.scene.film.height = height;
        return maker.scene;
    }
    static SessionOptions options_with(bool aov, Sampler sampler) {
        SessionOptions options;
        options.sampler = sampler;
        options.aov = aov;
        return options;
    }
    /// Sets the radiance of slots [0, count) to value(slot, channel).
    template <class Value>
    void set_radiance(std::uint32_t count, Value value) {
        const auto view = tables["radiance"].map(Access::read_write);
        auto *radiance = view.template as<float>();
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t slot = 0; slot < count; ++slot)
                radiance[std::size_t(radiance_value_r + c) * tables.rows().slots + slot] = float(value(slot, c));
    }

    /// Sets all features of all slots.
    void set_features(float value) {
        const auto view = tables["feature"].map(Access::write);
        std::fill_n(view.as<float>(), std::size_t(feature_columns) * tables.rows().slots, value);
    }

    Session session;
    Stages stages;
    Film film;
    Tables tables;
};

TEST_F(FilmTest, GivesEachPixelItsSamplesWhateverTheBatches) {
    constexpr std::uint32_t pixels = 7 * 3, samples = 100;
    const auto value = [](std::uint64_t sample, int c) { return double(sample % pixels) * 3 + c; };
    for (const std::uint32_t batch : {1u, 5u, 21u, 22u, 50u, 100u}) {
        FilmUnderTest test(device, 128, 7, 3, false);
        for (std::uint32_t done = 0; done < samples; done += batch) {
            const std::uint32_t count = std::min(batch, samples - done);
            test.set_radiance(count, [&](std::uint32_t slot, int c) { return value(done + slot, c); });
            test.film.add(count, done % pixels);
        }
        std::uint64_t non_finite = 0;
        const Image image = test.film.image(samples, non_finite);
        EXPECT_EQ(non_finite, 0u);
        EXPECT_EQ(image.width, 7u);
        EXPECT_EQ(image.height, 3u);
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
                ASSERT_EQ(image.find(c == 0   ? "R"
                                     : c == 1 ? "G"
                                              : "B")
                              ->values[pixel],
                          float(value(pixel, c)))
                    << "batches of " << batch << ", pixel " << pixel;
    }
}

// Without compensation a float sum of 1e4 and a hundred thousand of 4e-4 stays at 1e4: 4e-4 is less than half of its
// last place.
TEST_F(FilmTest, LosesNothingToRounding) {
    constexpr std::uint32_t slots = 8192, many = 100'000;
    FilmUnderTest test(device, slots, 1, 1, false);
    test.set_radiance(1, [](std::uint32_t, int) { return 1e4; });
    test.film.add(1, 0);
    test.set_radiance(slots, [](std::uint32_t, int) { return 4e-4; });
    for (std::uint32_t done = 0; done < many; done += slots)
        test.film.add(std::min(slots, many - done), 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(many + 1, non_finite);
    const double expected = (1e4 + many * double(4e-4f)) / (many + 1.0);
    for (const Channel &channel : image.channels)
        EXPECT_NEAR(channel.values[0], expected, 1e-6 * expected) << channel.name;
    // The same with plain sums, to see that the case is hard.
    float plain = 1e4f;
    for (std::uint32_t i = 0; i < many; ++i)
        plain += 4e-4f;
    EXPECT_GT(std::fabs(plain / (many + 1.0) - expected), 1e-3 * expected);
}

TEST_F(FilmTest, LeavesOutAndCountsWhatIsNotFinite) {
    constexpr std::uint32_t pixels = 4;
    FilmUnderTest test(device, 64, 2, 2, false);
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    // Three samples of each pixel. Pixel 0: all good. 1: a NaN in one channel. 2: infinities. 3: none that is good.
    const auto value = [&](std::uint32_t slot, int c) -> double {
        const std::uint32_t pixel = slot % pixels, sample = slot / pixels;
        if ((pixel == 1 && sample == 0 && c == 2) || (pixel == 3 && c == 0))
            return nan;
        if (pixel == 2 && sample > 0)
            return sample == 1 ? infinity : -infinity;
        return 1 + sample;
    };
    test.set_radiance(12, value);
    test.film.add(12, 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(12, non_finite);
    EXPECT_EQ(non_finite, 6u);
    for (const Channel &channel : image.channels) {
        EXPECT_EQ(channel.values[0], 2) << channel.name;
        EXPECT_EQ(channel.values[1], 2.5f) << channel.name;
        EXPECT_EQ(channel.values[2], 1) << channel.name;
        EXPECT_EQ(channel.values[3], 0) << channel.name;
    }
}

const char *const features[] = {"albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"};

/// Their features with them, or the rest's would be divided by too few.
TEST_F(FilmTest, LeavesOutFeaturesOfWhatIsNotFinite) {
    FilmUnderTest test(device, 64, 2, 1, true);
    test.set_features(0.25f);
    test.set_radiance(8, [](std::uint32_t slot, int c) {
        return slot % 2 == 1 && slot != 3 && c == 1 ? std::numeric_limits<double>::infinity() : 1;
    });
    test.film.add(8, 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(8, non_finite);
    EXPECT_EQ(non_finite, 3u);
    for (const char *feature : features)
        for (int pixel = 0; pixel < 2; ++pixel)
            EXPECT_FLOAT_EQ(image.find(feature)->values[pixel], 0.25f) << feature << " of pixel " << pixel;
}

/// What all samples see alike is their mean to the bit; plain sums of so many 0.9 are off by a thousandth. Samples
/// begin at a number of their own, as those of a pilot do.
TEST_F(FilmTest, LosesNothingOfFeaturesToRounding) {
    constexpr std::uint32_t slots = 8192, many = 16 * slots;
    constexpr std::uint64_t first = (std::uint64_t(1) << 62) + 12345;
    FilmUnderTest test(device, slots, 1, 1, true);
    test.film.clear(first);
    test.set_radiance(slots, [](std::uint32_t, int) { return 1; });
    test.set_features(0.9f);
    for (std::uint32_t done = 0; done < many; done += slots)
        test.film.add(slots, 0, first + done);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(many, non_finite);
    for (const char *feature : features)
        EXPECT_EQ(image.find(feature)->values[0], 0.9f) << feature;
    float plain = 0;
    for (std::uint32_t i = 0; i < many; ++i)
        plain += 0.9f;
    EXPECT_GT(std::fabs(plain / double(many) - 0.9), 1e-3) << "the case is to be hard";
}

/// And what differs has the mean that sums in double tell: each rounds by 2^-25 of it at most, and counts less the more
/// follow, sqrt(n / 3) of these in all, with four standard deviations.
TEST_F(FilmTest, KnowsTheMeanOfFeatures) {
    constexpr std::uint32_t count = 8192;
    FilmUnderTest test(device, count, 1, 1, true);
    test.set_radiance(count, [](std::uint32_t, int) { return 1; });
    double albedo = 0;
    test.set_features(0);
    {
        const auto view = test.tables["feature"].map(Access::read_write);
        for (std::uint32_t i = 0; i < count; ++i) {
            const float value = float(i * 7919 % 1009) / 1009;
            view.as<float>()[std::size_t(feature_albedo_r) * count + i] = value;
            albedo += value / double(count);
        }
    }
    test.film.add(count, 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(count, non_finite);
    EXPECT_NEAR(image.find("albedo.R")->values[0], albedo, 4 * std::sqrt(count / 3.0) * 0x1p-25 * albedo);
}

TEST_F(FilmTest, KnowsTheVarianceOfItsMean) {
    FilmUnderTest test(device, 64, 1, 1, true);
    test.tables["feature"].clear();
    test.set_radiance(4, [](std::uint32_t slot, int c) { return (c + 1) * double(slot); }); // 0, 1, 2, 3
    test.film.add(4, 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(4, non_finite);
    // Sample variance 5/3, over 4.
    EXPECT_FLOAT_EQ(image.find("variance.R")->values[0], float(5.0 / 12));
    EXPECT_FLOAT_EQ(image.find("variance.B")->values[0], float(9 * 5.0 / 12));
}

/// Two samples tell (x - y)^2 / 2, whatever they weigh, and whether each is a half by itself or not.
TEST_F(FilmTest, KnowsTheVarianceOfItsMeanWhereSamplesWeigh) {
    Scene scene = FilmUnderTest::scene_of(1, 1);
    scene.film.filter = FilmSettings::Filter::lanczos;
    scene.film.filter_radius = 3;
    const double values[] = {1, 1.001};
    for (const bool halves : {false, true}) {
        FilmUnderTest test(device, 64, scene, FilmUnderTest::options_with(true, FilmUnderTest::Sampler::independent),
                           halves);
        test.tables["feature"].clear();
        test.set_radiance(2, [&](std::uint32_t slot, int c) { return (c + 1) * values[slot]; });
        const SharedWeights::Sums first = test.film.weights().sums(1, 0, 1), both = test.film.weights().sums(2, 0, 1);
        {
            const auto view = test.tables["filtered"].map(Access::write);
            view.as<float>()[0] = float(first.weights);
            view.as<float>()[1] = float(both.weights - first.weights);
        }
        test.film.add(2, 0);
        std::uint64_t non_finite = 0;
        const Image image = test.film.image(2, non_finite);
        const double weight = test.film.weights().of_part(2, 0, 1);
        // The values are a thousandth apart, which is what leaves rounding.
        const double expected = 1e-6 / 2 * both.squares / (weight * weight);
        EXPECT_NEAR(image.find("variance.R")->values[0], expected, 1e-3 * expected) << halves;
        EXPECT_NEAR(image.find("variance.B")->values[0], 9 * expected, 9e-3 * expected) << halves;
    }
}

/// A place and a width whose sum is small in 32 bits.
TEST_F(FilmTest, LiesWithinItsImage) {
    Scene scene = FilmUnderTest::scene_of(4, 4);
    scene.film.crop_width = scene.film.crop_height = 2;
    const auto refuses = [&](std::uint32_t x, std::uint32_t y) {
        scene.film.crop_x = x;
        scene.film.crop_y = y;
        EXPECT_THROW(Session(device, scene, SessionOptions(), {}), Error) << x << ", " << y;
    };
    refuses(0xFFFFFFFF, 0);
    refuses(0, 0xFFFFFFFF);
    refuses(3, 0);
}

/// Of five samples and a pixel that has four, the first is one that the fifth is like: sample s is of replicate s
/// modulo 4, whatever the batches.
TEST_F(FilmTest, KnowsTheVarianceOfReplicates) {
    constexpr std::uint32_t pixels = 2, samples = 9;
    const double values[] = {1, 4, 2, 8, 7};
    for (const std::uint32_t batch : {1u, 2u, 3u, 9u}) {
        FilmUnderTest test(device, 64, 2, 1, true, SessionOptions::Sampler::sobol);
        test.tables["feature"].clear();
        for (std::uint32_t done = 0; done < samples; done += batch) {
            test.set_radiance(std::min(batch, samples - done),
                              [&](std::uint32_t slot, int c) { return (c + 1) * values[(done + slot) / pixels]; });
            test.film.add(std::min(batch, samples - done), done % pixels, done / pixels);
        }
        std::uint64_t non_finite = 0;
        const Image image = test.film.image(samples, non_finite);
        // Pixel 0: (1 + 7) / 2, 4, 2 and 8; all in all 22 / 5. Pixel 1: 1, 4, 2 and 8.
        const double first = variance_of_mean(std::vector<Replicate>{{8, 2}, {4, 1}, {2, 1}, {8, 1}}),
                     second = (2.75 * 2.75 + 0.25 * 0.25 + 1.75 * 1.75 + 4.25 * 4.25) / 12;
        EXPECT_FLOAT_EQ(image.find("R")->values[0], float(22.0 / 5));
        EXPECT_FLOAT_EQ(image.find("variance.R")->values[0], float(first)) << batch;
        EXPECT_FLOAT_EQ(image.find("variance.G")->values[0], float(4 * first)) << batch;
        EXPECT_FLOAT_EQ(image.find("variance.B")->values[1], float(9 * second)) << batch;
    }
}

/// A replicate of which a sample was left out has fewer.
TEST_F(FilmTest, KnowsTheVarianceOfReplicatesWithoutWhatIsNotFinite) {
    FilmUnderTest test(device, 64, 1, 1, true, SessionOptions::Sampler::sobol);
    test.tables["feature"].clear();
    const double values[] = {1, 4, 2, 8, std::numeric_limits<double>::infinity(), 6, 3, 5};
    test.set_radiance(8, [&](std::uint32_t slot, int) { return values[slot]; });
    test.film.add(8, 0);
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(8, non_finite);
    EXPECT_EQ(non_finite, 1u);
    EXPECT_FLOAT_EQ(image.find("R")->values[0], float(29.0 / 7));
    EXPECT_FLOAT_EQ(image.find("variance.G")->values[0],
                    float(variance_of_mean(std::vector<Replicate>{{1, 1}, {10, 2}, {5, 2}, {13, 2}})));
}

} // namespace
} // namespace gradus
