// The same kernels on a second OpenCL implementation, for the CPU or a GPU: images agree. Run by with_second_device.py,
// which makes both implementations visible.
#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/error.h"
#include "runtime/film/block_test.h"
#include "runtime/io/load_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

namespace gradus {
namespace {

constexpr std::size_t seeds = 8;

class SecondDevice : public ::testing::TestWithParam<const char *> {
  protected:
    static Device &first() {
        static Device device("portable computing");
        return device;
    }
    static Device &second() {
        static Device device(name_of_second());
        return device;
    }
    /// Of the first device that another implementation than the first's offers.
    static std::string name_of_second() {
        for (const DeviceDescription &found : list_devices())
            if (found.platform != first().description().platform)
                return found.platform;
        throw Error(ExitCode::device, "there is no second OpenCL implementation");
    }
    static Scene scene(std::uint64_t samples_per_pixel) {
        Scene scene = load_scene(fmt::format("{}/{}.xml", GRADUS_SCENES, GetParam())).scene;
        scene.film.width = 128;
        scene.film.height = 96;
        scene.film.crop_width = scene.film.crop_height = 0;
        scene.settings.samples_per_pixel = samples_per_pixel;
        return scene;
    }
    static Image render(Device &device, const Scene &scene, std::uint64_t seed, const char *name = "pt") {
        RenderOptions options;
        options.seed = seed;
        const auto method = make_method(name, device, scene, options);
        while (method->render_batch()) {
        }
        const Image image = method->image();
        EXPECT_EQ(method->statistics().non_finite, 0u);
        return image;
    }
    static std::vector<Image> render_seeds(Device &device, const Scene &scene, std::uint64_t first_seed,
                                           const char *name) {
        std::vector<Image> images;
        for (std::size_t i = 0; i < seeds; ++i)
            images.push_back(render(device, scene, first_seed + i, name));
        return images;
    }

    /// Other seeds, so that the images are independent: any difference of their means beyond chance is an error of one.
    static void expect_agreement(const char *name, std::uint64_t spp) {
        const Scene own = scene(spp);
        const auto reference = testing::mean_and_variance(render_seeds(first(), own, 1, name));
        const std::vector<Image> images = render_seeds(second(), own, 101, name);
        for (const int block : {0, 16}) {
            const BlockTest test = block_z_test(images, reference.mean, reference.variance, double(spp),
                                                double(spp * seeds), block, int(seeds));
            EXPECT_TRUE(test.passed()) << "block " << block << ": largest |z| " << test.largest << ", limit "
                                       << test.largest_limit << "; " << test.over_three << " over 3, limit "
                                       << test.over_three_limit;
            ::testing::Test::RecordProperty(block ? "largest_z_of_blocks" : "largest_z_of_image",
                                            std::to_string(test.largest));
            std::printf("  %s: largest |z| %.2f of %zu (limit %.2f), %zu over 3 (limit %zu)\n",
                        block ? "blocks" : "image ", test.largest, test.tested, test.largest_limit, test.over_three,
                        test.over_three_limit);
        }
    }
};

TEST_P(SecondDevice, IsNotTheFirst) { EXPECT_NE(first().description().platform, second().description().platform); }

TEST_P(SecondDevice, ImagesOfOtherSeedsAgreeStatistically) { expect_agreement("pt", 32); }

TEST_P(SecondDevice, ReconstructedImagesOfOtherSeedsAgreeStatistically) { expect_agreement("gpt", 8); }

// The random numbers are whole numbers, so both devices walk the same paths but where rounding decides otherwise.
TEST_P(SecondDevice, TheSameSeedGivesNearlyTheSamePixels) {
    const Scene own = scene(4);
    const Image a = render(first(), own, 7), b = render(second(), own, 7), other = render(second(), own, 8);
    const auto differing = [&](const Image &x, const Image &y) {
        std::size_t count = 0, values = 0;
        for (const Channel &channel : x.channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i, ++values) {
                const double p = channel.values[i], q = y.find(channel.name)->values[i];
                count += std::abs(p - q) > 1e-3 * std::max(std::abs(p), std::abs(q));
            }
        return double(count) / double(values);
    };
    std::printf("  values that differ by over 0.1 %%: %.3f %%; of another seed %.1f %%\n", 100 * differing(a, b),
                100 * differing(b, other));
    EXPECT_LT(differing(a, b), 0.01);
    EXPECT_GT(differing(b, other), 0.25) << "the measure sees nothing";
}

INSTANTIATE_TEST_SUITE_P(Scenes, SecondDevice,
                         ::testing::Values("cornell-box", "torus-rough-glass", "plates", "door-ajar", "holes",
                                           "materials"),
                         testing::name_of_scene);

} // namespace
} // namespace gradus
