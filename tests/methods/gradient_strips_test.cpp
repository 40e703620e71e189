// Gradient-domain path tracing of an image in strips of rows: what a strip is must not be seen in any layer.
#include "planning/make_method.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"

#include <cstring>

namespace gradus::testing {
namespace {

constexpr std::uint32_t width = 200, height = 17;
constexpr std::uint64_t strip_samples = 5;

/// Batches for passes (four batches long) of so many rows of the crop, or of so many frames.
struct StripCase {
    std::uint32_t batch_size, rows, frames;
};
constexpr StripCase strip_cases[] = {{64, 1, 1},   {128, 2, 1},      {192, 3, 1},       {448, 8, 1},
                                     {832, 16, 1}, {896, height, 1}, {1728, height, 2}, {2560, height, 3}};

class GradientStrips : public ::testing::TestWithParam<const char *> {
  protected:
    static Scene scene(std::uint64_t samples) {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 256, 192);
        scene.film.crop_x = 20;
        scene.film.crop_y = 90;
        scene.film.crop_width = width;
        scene.film.crop_height = height;
        scene.settings.samples_per_pixel = samples;
        return scene;
    }
    static RenderOptions options(std::uint32_t batch_size) {
        RenderOptions options;
        options.batch_size = batch_size;
        options.reconstruction = Reconstruction::l2;
        options.layers = options.aov = true;
        return options;
    }
    static Image image_of(std::uint64_t samples) { return render(scene(samples), options(0), "gpt").image; }
};

TEST_P(GradientStrips, OfAnyHeightMakeTheSameImage) {
    const Image whole = image_of(strip_samples);
    for (const char *layer : {"R", "primal.G", "dx.G", "dy.G", "albedo.R"})
        ASSERT_NE(whole.find(layer), nullptr) << layer;
    for (const StripCase &c : strip_cases) {
        const std::unique_ptr<Method> method =
            make_method("gpt", shared_device(), scene(strip_samples), options(c.batch_size));
        std::uint64_t before = 0, passes = 0;
        while (method->done_samples() < method->total_samples()) {
            method->render_batch();
            const std::uint64_t done = method->done_samples();
            // The last strip of a frame and the last frames may be fewer.
            const std::uint64_t first = before % (width * height) / width;
            const std::uint64_t rows = std::min<std::uint64_t>(c.rows, height - first);
            const std::uint64_t frames =
                c.rows == height ? std::min<std::uint64_t>(c.frames, strip_samples - before / (width * height)) : 1;
            ASSERT_EQ(done - before, rows * frames * width) << "pass " << passes << " of batches of " << c.batch_size;
            before = done;
            ++passes;
        }
        EXPECT_TRUE(equal_bits(whole, method->image())) << "strips of " << c.rows << " rows";
        EXPECT_EQ(method->statistics().non_finite, 0u);
    }
}

bool equal_rows(const Channel &a, const Channel &b, std::size_t first, std::size_t end) {
    return std::memcmp(&a.values[first * width], &b.values[first * width], (end - first) * width * sizeof(float)) == 0;
}

// Rows that are done have a sample more than the others; each is divided by its own number. A difference to the row
// below has a sample more where both rows have.
TEST_P(GradientStrips, GiveTheirImageInTheMiddleOfAFrame) {
    std::vector<Image> of_samples(1);
    for (std::uint64_t samples = 1; samples <= 3; ++samples)
        of_samples.push_back(image_of(samples));
    of_samples[0] = of_samples[1];
    for (Channel &channel : of_samples[0].channels)
        std::fill(channel.values.begin(), channel.values.end(), 0.0f);
    for (const StripCase &c : strip_cases) {
        if (c.rows == height)
            continue;
        const std::unique_ptr<Method> method = make_method("gpt", shared_device(), scene(3), options(c.batch_size));
        bool is_partial = false;
        while (method->render_batch()) {
            const std::uint64_t frames = method->done_samples() / (width * height);
            const std::uint64_t rows = method->done_samples() % (width * height) / width;
            // Not all of them: each takes a reconstruction.
            if (rows == 0 || (rows != c.rows && rows + c.rows < height && rows / c.rows != 4))
                continue;
            is_partial = true;
            const Image image = method->image();
            EXPECT_EQ(count_non_finite(image), 0u);
            for (const char *name : {"primal", "dx", "dy", "albedo"})
                for (const char *color : {"R", "G", "B"}) {
                    const std::string layer = std::string(name) + "." + color;
                    const Channel &mixed = *image.find(layer), &more = *of_samples[frames + 1].find(layer),
                                  &less = *of_samples[frames].find(layer);
                    const std::size_t done = layer.starts_with("dy") ? rows - 1 : rows;
                    EXPECT_TRUE(equal_rows(mixed, more, 0, done)) << layer << " with " << rows << " rows of frame "
                                                                  << frames << " done, " << c.rows << " a strip";
                    EXPECT_TRUE(equal_rows(mixed, less, done, height)) << layer << " with " << rows << " rows of frame "
                                                                       << frames << " done, " << c.rows << " a strip";
                }
        }
        EXPECT_TRUE(is_partial);
        EXPECT_TRUE(equal_bits(method->image(), of_samples[3])) << "images on the way change what comes";
    }
}

/// Rows whose first sample is still to come are black, and what is done does not know of that: of a white floor under a
/// white sky each sample is 1, and no difference is other than 0.
TEST(UnfinishedGradientStrips, AreAsBrightAsTheyWillBe) {
    SceneMaker maker(64, 1);
    maker.look({0, 1, 0}, {0, 0, 0}, 40, {0, 0, 1});
    maker.floor(-1, 1, 1, maker.material(diffuse(1)));
    maker.environment(1);
    maker.scene.settings.max_depth = 2;
    for (const auto reconstruction : {Reconstruction::l1, Reconstruction::l2}) {
        RenderOptions options;
        options.batch_size = 64;
        options.reconstruction = reconstruction;
        options.strategy = RenderOptions::Strategy::bsdf;
        const auto method = make_method("gpt", shared_device(), maker.scene, options);
        while (method->done_samples() < 64 * 24)
            ASSERT_TRUE(method->render_batch());
        const std::size_t done = method->done_samples();
        const Image image = method->image();
        for (const char *color : {"R", "G", "B"})
            for (std::size_t i = 0; i < 64 * 64; ++i)
                ASSERT_NEAR(image.find(color)->values[i], i < done ? 1 : 0, 1e-5) << i << " of " << done;
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientStrips, ::testing::Values("cornell-box"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, GradientStrips, ::testing::Values("materials"), name_of_scene);

} // namespace
} // namespace gradus::testing
