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
#include "kernels/lib/filter_table.h"
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
          tables(device, film.tables(), {64, slots, session.pixels(), session.width(), 1}, Precision::single) {
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

    /// Sets the depth of slots [0, count) to value(slot).
    template <class Value>
    void set_depth(std::uint32_t count, Value value) {
        const auto view = tables["feature"].map(Access::read_write);
        for (std::uint32_t slot = 0; slot < count; ++slot)
            view.template as<float>()[std::size_t(feature_depth) * tables.rows().slots + slot] = float(value(slot));
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

/// Also where halves are films of their own, and where noise is a hundred-thousandth of the value.
TEST_F(FilmTest, KnowsTheVarianceOfItsMean) {
    for (const bool halves : {false, true})
        for (const double apart : {1.0, 0x1p-15}) {
            FilmUnderTest test(device, 64, FilmUnderTest::scene_of(1, 1),
                               FilmUnderTest::options_with(true, FilmUnderTest::Sampler::independent), halves);
            test.tables["feature"].clear();
            // 0, 1, 2, 3 times that, upon 1.
            test.set_radiance(4, [apart](std::uint32_t slot, int c) { return (c + 1) * (1 + apart * slot); });
            test.film.add(4, 0);
            std::uint64_t non_finite = 0;
            const Image image = test.film.image(4, non_finite);
            // Sample variance 5/3, over 4.
            const double expected = 5.0 / 12 * apart * apart;
            EXPECT_NEAR(image.find("variance.R")->values[0], expected, 1e-3 * expected) << halves << ", " << apart;
            EXPECT_NEAR(image.find("variance.B")->values[0], 9 * expected, 9e-3 * expected) << halves << ", " << apart;
        }
}

/// A film whose samples count for the pixels around.
Scene scene_with_filter(std::uint32_t width, std::uint32_t height, FilmSettings::Filter filter, float radius) {
    Scene scene = FilmUnderTest::scene_of(width, height);
    scene.film.filter = filter;
    scene.film.filter_radius = radius;
    return scene;
}

/// What samples of a frame add up to at a pixel of the image, in double; `sample(x, y)` of the film and what is around.
template <class Sample>
double filtered(const Session &session, std::uint64_t frame, int x, int y, const Sample &sample) {
    const FramePlace place = frame_place(session, frame);
    const auto reach = int(session.border);
    const float *taps = session.scene.filter.taps.data();
    double sum = 0;
    for (int j = -reach; j <= reach; ++j)
        for (int i = -reach; i <= reach; ++i)
            sum += double(filter_tap(taps, session.border, filter_place_at(place.x), std::uint32_t(reach - i))) *
                   filter_tap(taps, session.border, filter_place_at(place.y), std::uint32_t(reach - j)) *
                   sample(x + i, y + j);
    return sum;
}

/// Whatever the batches are; and of a frame that is there in part only the pixels that have all around them.
TEST_F(FilmTest, FiltersWhatIsAround) {
    constexpr std::uint32_t width = 6, height = 4, frames = 5;
    using Filter = FilmSettings::Filter;
    for (const auto &[filter, radius] : {std::pair{Filter::gaussian, 2.0f},
                                         {Filter::tent, 1.0f},
                                         {Filter::lanczos, 3.0f},
                                         {Filter::tent, 5.0f},
                                         {Filter::tent, 0.4f}}) {
        const auto value = [](std::uint64_t sample, int c) { return double(sample * 7919 % 1009) / 1009 + c; };
        std::vector<float> first;
        for (const std::uint32_t batch : {1000u, 37u, 16u}) {
            FilmUnderTest test(device, 1024, scene_with_filter(width, height, filter, radius),
                               FilmUnderTest::options_with(true, FilmUnderTest::Sampler::independent), false);
            const std::uint32_t wide = test.session.width(), pixels = test.session.pixels();
            const auto border = int(test.session.border);
            ASSERT_EQ(pixels, (width + 2 * border) * (height + 2 * border));
            // All of some frames, and of one more the image's first two rows with what is around them, and a pixel.
            const std::uint32_t samples = frames * pixels + (2 * border + 2) * wide + 2 * border + 1;
            test.set_features(0.5f);
            for (std::uint32_t done = 0, count; done < samples; done += count) {
                count = std::min(batch, samples - done);
                test.set_radiance(count, [&](std::uint32_t slot, int c) { return value(done + slot, c); });
                test.set_depth(count, [&](std::uint32_t slot) { return value(done + slot, 3); });
                test.film.add(count, done % pixels, done / pixels);
            }
            std::uint64_t non_finite = 0;
            const Image image = test.film.image(samples, non_finite);
            ASSERT_EQ(image.width, width);
            ASSERT_EQ(image.height, height);
            for (std::uint32_t pixel = 0; pixel < width * height; ++pixel) {
                const int x = int(pixel % width), y = int(pixel / width);
                const std::uint32_t count = frames + (pixel <= 2 * width ? 1 : 0);
                double mean = 0; // of what is about a half
                for (std::uint32_t frame = 0; frame < count; ++frame)
                    mean +=
                        filtered(test.session, frame, x, y,
                                 [&](int column, int row) {
                                     return value(std::uint64_t(frame) * pixels + std::uint64_t(row + border) * wide +
                                                      std::uint64_t(column + border),
                                                  0);
                                 }) /
                        count;
                ASSERT_NEAR(image.find("G")->values[pixel], 1 + mean, 1e-5)
                    << radius << ", batches of " << batch << ", " << x << ", " << y;
                ASSERT_NEAR(image.find("depth.Z")->values[pixel], 3 + mean, 1e-5) << radius << ", " << x << ", " << y;
            }
            EXPECT_NEAR(image.find("albedo.R")->values[width], 0.5, 1e-6); // constant
            std::vector<float> all;
            for (const Channel &channel : image.channels)
                all.insert(all.end(), channel.values.begin(), channel.values.end());
            if (first.empty())
                first = all;
            EXPECT_EQ(first, all) << radius << ", batches of " << batch;
        }
    }
}

/// What is not finite is left out of all pixels that it counts for, and of no others.
TEST_F(FilmTest, LeavesOutWhatIsNotFiniteAround) {
    constexpr std::uint32_t size = 9;
    FilmUnderTest test(device, 512, scene_with_filter(size, size, FilmSettings::Filter::tent, 1),
                       FilmUnderTest::options_with(false, FilmUnderTest::Sampler::independent), false);
    const std::uint32_t pixels = test.session.pixels();
    const std::size_t bad = test.session.sampled_pixel(4 * size + 3);
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
        test.set_radiance(pixels, [&](std::uint32_t slot, int) {
            return frame == 1 && slot == bad ? std::numeric_limits<double>::quiet_NaN() : frame + 1.0;
        });
        test.film.add(pixels, 0, frame);
    }
    std::uint64_t non_finite = 0;
    const Image image = test.film.image(2 * pixels, non_finite);
    EXPECT_EQ(non_finite, 9u);
    for (int y = 0; y < int(size); ++y)
        for (int x = 0; x < int(size); ++x)
            EXPECT_NEAR(image.find("R")->values[std::size_t(y) * size + std::size_t(x)],
                        std::abs(x - 3) <= 1 && std::abs(y - 4) <= 1 ? 1 : 1.5, 1e-6)
                << x << ", " << y;
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
