// What must not change an image, and what must.
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

class Invariance : public ::testing::TestWithParam<const char *> {
  protected:
    /// More samples than the largest batch below holds, and no multiple of any batch.
    Scene scene() const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 321, 241);
        scene.settings.samples_per_pixel = 5;
        return scene;
    }
    Scene small_scene() const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 64, 48);
        scene.settings.samples_per_pixel = 4;
        return scene;
    }
};

TEST_P(Invariance, ToTheBatchSize) {
    RenderOptions options;
    options.batch_size = 65536;
    const Image image = render(scene(), options).image;
    for (const std::uint32_t batch_size : {1000u, 333'333u}) {
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene(), options).image)) << "batch size " << batch_size;
    }
}

TEST_P(Invariance, ToTheCrop) {
    Scene scene = small_scene();
    const Image whole = render(scene).image;
    scene.film.crop_x = 13;
    scene.film.crop_y = 7;
    scene.film.crop_width = 31;
    scene.film.crop_height = 29;
    const Image crop = render(scene).image;
    ASSERT_EQ(crop.width, 31u);
    ASSERT_EQ(crop.height, 29u);
    std::size_t different = 0;
    for (const char *channel : {"R", "G", "B"})
        for (std::uint32_t y = 0; y < crop.height; ++y)
            for (std::uint32_t x = 0; x < crop.width; ++x)
                different += pixel(crop, x, y, channel) != pixel(whole, x + 13, y + 7, channel) ? 1 : 0;
    EXPECT_EQ(different, 0u);
}

TEST_P(Invariance, ToLayers) {
    RenderOptions options;
    options.aov = true;
    const Image plain = render(small_scene()).image, layered = render(small_scene(), options).image;
    EXPECT_GT(layered.channels.size(), plain.channels.size());
    for (const Channel &channel : plain.channels)
        EXPECT_EQ(channel.values, layered.find(channel.name)->values) << channel.name;
}

TEST_P(Invariance, NotToTheSeed) {
    RenderOptions first, second, high;
    second.seed = 1;
    high.seed = std::uint64_t(1) << 32; // the upper half counts, too
    const Image image = render(small_scene(), first).image;
    EXPECT_TRUE(equal_bits(image, render(small_scene(), first).image));
    EXPECT_FALSE(equal_bits(image, render(small_scene(), second).image));
    EXPECT_FALSE(equal_bits(image, render(small_scene(), high).image));
}

// Kernels with every trait on compute the same, but a compiler may join multiplications and additions otherwise.
TEST_P(Invariance, ToSpecialisation) {
    RenderOptions options;
    const Image special = render(small_scene(), options).image;
    options.all_traits = true;
    const Image general = render(small_scene(), options).image;
    double largest = 0;
    std::size_t different = 0;
    for (const Channel &channel : special.channels)
        for (std::size_t i = 0; i < channel.values.size(); ++i) {
            const double a = channel.values[i], b = general.find(channel.name)->values[i];
            different += a != b ? 1 : 0;
            largest = std::max(largest, std::fabs(a - b) / std::max(1.0, std::fabs(a)));
        }
    fmt::print("{}: {} of {} values differ between specialised and general kernels, at most by {:.2g}\n", GetParam(),
               different, 3 * special.channels[0].values.size(), largest);
    EXPECT_LE(largest, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Image, Invariance, ::testing::Values("cornell-box", "plates", "materials"),
                         [](const auto &info) {
                             std::string name = info.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

TEST(PartialImage, DividesEachPixelByItsOwnCount) {
    SceneMaker maker(20, 3); // 400 pixels
    maker.look({0, 0, -3}, {0, 0, 0}, 40);
    maker.sphere({0, 0, 0}, 0.5f, maker.material(diffuse(1)));
    maker.environment(1);
    RenderOptions options;
    options.strategy = RenderOptions::Strategy::bsdf;
    options.batch_size = 128;
    const std::unique_ptr<Method> method = make_method("pt", shared_device(), maker.scene, options);
    std::uint64_t batches = 0;
    do {
        const Image image = method->image();
        const std::uint64_t done = method->done_samples();
        EXPECT_EQ(done, 128 * batches);
        for (std::uint32_t i = 0; i < 400; ++i)
            ASSERT_NEAR(image.find("G")->values[i], i < done ? 1 : 0, 1e-5) << "pixel " << i << " after " << done;
        ++batches;
    } while (method->render_batch());
    EXPECT_EQ(method->done_samples(), 1200u);
    EXPECT_FALSE(method->render_batch());
    EXPECT_NEAR(spread_of(method->image()).least, 1, 1e-5);
    EXPECT_NEAR(spread_of(method->image()).most, 1, 1e-5);
}

} // namespace
} // namespace gradus::testing
