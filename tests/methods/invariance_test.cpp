// What must not change an image, and what must.
#include "planning/make_method.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

class Invariance : public ::testing::TestWithParam<const char *> {
  protected:
    Scene small_scene() const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 64, 48);
        scene.settings.samples_per_pixel = 4;
        return scene;
    }
};

void expect_same_for_batch_sizes(const Scene &scene, std::initializer_list<std::uint32_t> batch_sizes) {
    const Image image = render(scene).image;
    for (const std::uint32_t batch_size : batch_sizes) {
        RenderOptions options;
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options).image)) << "batch size " << batch_size;
    }
}

TEST_P(Invariance, ToTheBatchSize) {
    Scene scene = own_scene(std::string(GetParam()) + ".xml", 81, 61); // 19764 samples
    scene.settings.samples_per_pixel = 4;
    expect_same_for_batch_sizes(scene, {64, 1000, 5000});
}

// More samples than the largest batch holds.
TEST(LargeBatches, DoNotChangeTheImage) {
    Scene scene = own_scene("cornell-box.xml", 321, 241);
    scene.settings.samples_per_pixel = 5;
    scene.settings.max_depth = 4;
    expect_same_for_batch_sizes(scene, {10'000, 65'536, 333'333});
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
    options.variance = false; // for which samples are drawn otherwise
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

/// How many values of two images differ, and how many by more than rounding.
struct Differences {
    std::size_t count = 0, different = 0, far = 0;

    void add(const Image &first, const Image &second, const std::string &channel) {
        const std::vector<float> &values = first.find(channel)->values, &others = second.find(channel)->values;
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double a = values[i], b = others[i];
            ++count;
            different += a != b ? 1 : 0;
            far += std::fabs(a - b) > 1e-4 * std::max(0.1, std::fabs(a)) ? 1 : 0;
        }
    }
};

// Kernels with every trait on, with triangles by index too, compute the same, but a compiler may join multiplications
// and additions otherwise. What that changes in the last bits sends a path another way now and then: past an edge, or
// on with Russian roulette.
TEST_P(Invariance, ToSpecialisationButForRounding) {
    RenderOptions options;
    const Image special = render(small_scene(), options).image;
    options.all_traits = options.by_index = true;
    const Image general = render(small_scene(), options).image;
    Differences found;
    for (const Channel &channel : special.channels)
        found.add(special, general, channel.name);
    fmt::print("{}: of {} values {} differ between specialised and general kernels, {} by more than 1e-4\n", GetParam(),
               found.count, found.different, found.far);
    EXPECT_LE(found.far, found.count / 100);
}

/// Triangles by index, in all methods: normals, anisotropy, lights, walks and photons. Offsets of rays are computed in
/// other places with other rounding, so a path goes another way now and then, as above.
class ByIndex : public ::testing::TestWithParam<std::tuple<const char *, const char *>> {};

TEST_P(ByIndex, IsTheSameButForRounding) {
    const auto [name, method] = GetParam();
    Scene scene = own_scene(std::string(name) + ".xml", 64, 48);
    scene.settings.samples_per_pixel = 4;
    RenderOptions options;
    const Image by_record = render(scene, options, method).image;
    options.by_index = true;
    const Image by_index = render(scene, options, method).image;
    Differences found;
    // Before a reconstruction, which shows one path in many pixels.
    for (const char *color : {"R", "G", "B"}) {
        const std::string layer = std::string("primal.") + color;
        found.add(by_record, by_index, by_record.find(layer) ? layer : color);
    }
    fmt::print("{} by {}: of {} values {} differ by more than 1e-4\n", name, method, found.count, found.far);
    EXPECT_LE(found.far, found.count / 20);
}

INSTANTIATE_TEST_SUITE_P(Full, ByIndex,
                         ::testing::Combine(::testing::Values("materials", "slab-and-ball"),
                                            ::testing::Values("pt", "gpt", "sppm", "gpm")),
                         [](const auto &parameter) {
                             std::string name =
                                 std::string(std::get<0>(parameter.param)) + "_" + std::get<1>(parameter.param);
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

/// Materials read class by class, and all by one kernel that has what any of them needs.
class MaterialClassesOf : public ::testing::TestWithParam<std::tuple<const char *, const char *>> {};

TEST_P(MaterialClassesOf, ReadTheSameButForRounding) {
    const auto [name, method] = GetParam();
    Scene scene = own_reference(name).scene;
    scene.settings.samples_per_pixel = 4;
    RenderOptions options;
    options.aov = true; // the features: what is read of first vertices
    const Image by_class = render(scene, options, method).image;
    options.all_traits = true;
    const Image by_one = render(scene, options, method).image;
    Differences found;
    for (const char *channel : {"albedo.R", "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z"}) {
        ASSERT_TRUE(by_class.find(channel) && by_one.find(channel)) << channel;
        found.add(by_class, by_one, channel);
    }
    fmt::print("{} by {}: of {} values {} differ by more than 1e-4\n", name, method, found.count, found.far);
    EXPECT_LE(found.far, found.count / 100);
}

INSTANTIATE_TEST_SUITE_P(Full, MaterialClassesOf,
                         ::testing::Combine(::testing::Values("textures", "relief"),
                                            ::testing::Values("pt", "gpt", "sppm")),
                         [](const auto &parameter) {
                             return std::string(std::get<0>(parameter.param)) + "_" + std::get<1>(parameter.param);
                         });

INSTANTIATE_TEST_SUITE_P(Image, Invariance, ::testing::Values("cornell-box", "plates", "materials"), name_of_scene);

TEST(PartialImage, DividesEachPixelByItsOwnCount) {
    constexpr std::uint32_t pixels = 50 * 50;
    SceneMaker maker(50, 3);
    maker.look({0, 0, -3}, {0, 0, 0}, 40);
    maker.sphere({0, 0, 0}, 0.5f, maker.material(diffuse(1)));
    maker.environment(1);
    RenderOptions options;
    options.strategy = RenderOptions::Strategy::bsdf;
    options.batch_size = 64;
    const std::unique_ptr<Method> method = make_method("pt", shared_device(), maker.scene, options);
    std::size_t within_a_sample = 0;
    for (;;) {
        const Image image = method->image();
        const std::uint64_t done = method->done_samples();
        within_a_sample += done > 0 && done < pixels ? 1 : 0;
        for (std::uint32_t i = 0; i < pixels; ++i)
            ASSERT_NEAR(image.find("G")->values[i], i < done ? 1 : 0, 1e-5) << "pixel " << i << " after " << done;
        if (done == method->total_samples())
            break;
        const bool more = method->render_batch();
        EXPECT_EQ(more, method->done_samples() < 3 * pixels);
        ASSERT_GT(method->done_samples(), done);
    }
    EXPECT_GT(within_a_sample, 0u) << "no image was partial";
    EXPECT_EQ(method->done_samples(), 3 * pixels);
    EXPECT_FALSE(method->render_batch());
}

} // namespace
} // namespace gradus::testing
