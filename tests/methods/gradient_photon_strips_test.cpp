// Gradient-domain photon mapping of an image in strips of rows: what a strip is must not be seen, neither in the end
// nor in images on the way.
#include "planning/make_method.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_name.h"

#include <cstring>

namespace gradus::testing {
namespace {

constexpr std::uint32_t width = 60, height = 13;
constexpr std::uint64_t pixels = width * height;

class GradientPhotonStrips : public ::testing::TestWithParam<const char *> {
  protected:
    static std::unique_ptr<Method> method(std::uint64_t passes, std::uint32_t batch_size) {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 80, 60);
        scene.film.crop_x = 10;
        scene.film.crop_y = 30;
        scene.film.crop_width = width;
        scene.film.crop_height = height;
        scene.settings.samples_per_pixel = passes;
        RenderOptions options;
        options.photons = 2000;
        options.radius = RenderOptions::GatherRadius{1.5, false};
        options.batch_size = batch_size;
        options.reconstruction = Reconstruction::l2;
        options.layers = options.aov = true;
        return make_method("gpm", shared_device(), scene, options);
    }
    static Image image_of(std::uint64_t passes) {
        const std::unique_ptr<Method> whole = method(passes, 0);
        while (whole->render_batch()) {
        }
        return whole->image();
    }
};

bool equal_rows(const Channel &a, const Channel &b, std::size_t first, std::size_t end) {
    return std::memcmp(&a.values[first * width], &b.values[first * width], (end - first) * width * sizeof(float)) == 0;
}

// Strips are four batches of the five camera paths that a pixel has. Rows that are done have a pass more than the
// others, and each is divided by its own number; a difference to the row below has one more where both rows have.
TEST_P(GradientPhotonStrips, GiveTheirImageInTheMiddleOfAPass) {
    std::vector<Image> of_passes(1);
    for (std::uint64_t passes = 1; passes <= 2; ++passes)
        of_passes.push_back(image_of(passes));
    of_passes[0] = of_passes[1];
    for (Channel &channel : of_passes[0].channels)
        std::fill(channel.values.begin(), channel.values.end(), 0.0f);
    for (const auto &[batch_size, strip] : {std::pair{64u, 1u}, {256u, 3u}, {640u, 8u}}) {
        const std::unique_ptr<Method> render = method(2, batch_size);
        std::uint64_t before = 0;
        bool is_partial = false;
        while (render->render_batch()) {
            const std::uint64_t done = render->done_samples(), rows = done % pixels / width;
            const std::uint64_t before_rows = before % pixels / width;
            ASSERT_EQ(done - before, std::min<std::uint64_t>(strip, height - before_rows) * width);
            before = done;
            if (rows == 0 || (rows != strip && rows != 4 * strip))
                continue; // each image takes a reconstruction
            is_partial = true;
            const Image image = render->image();
            EXPECT_EQ(count_non_finite(image), 0u);
            const std::uint64_t passes = done / pixels;
            for (const char *name : {"primal", "dx", "dy", "albedo"})
                for (const char *color : {"R", "G", "B"}) {
                    const std::string layer = std::string(name) + "." + color;
                    const Channel &mixed = *image.find(layer);
                    const std::size_t end = layer.starts_with("dy") ? rows - 1 : rows;
                    EXPECT_TRUE(equal_rows(mixed, *of_passes[passes + 1].find(layer), 0, end))
                        << layer << " with " << rows << " rows of pass " << passes << " done, " << strip << " a strip";
                    EXPECT_TRUE(equal_rows(mixed, *of_passes[passes].find(layer), end, height))
                        << layer << " with " << rows << " rows of pass " << passes << " done, " << strip << " a strip";
                }
        }
        EXPECT_TRUE(is_partial);
        EXPECT_TRUE(equal_bits(render->image(), of_passes[2])) << "images on the way change what comes";
        EXPECT_EQ(render->statistics().non_finite, 0u);
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientPhotonStrips, ::testing::Values("cornell-box", "lamp-in-egg"), name_of_scene);

} // namespace
} // namespace gradus::testing
