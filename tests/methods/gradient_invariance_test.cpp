// Gradient-domain path tracing: what must not change its image.
#include "runtime/error.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"
#include "tests/support/test_name.h"

#include <algorithm>

namespace gradus::testing {
namespace {

class GradientInvariance : public ::testing::TestWithParam<const char *> {
  protected:
    Scene small_scene(std::uint32_t width, std::uint32_t height) const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", width, height);
        scene.settings.samples_per_pixel = 5;
        return scene;
    }
};

/// Frames of 1271 pixels: less than a pass, and more than a batch.
TEST_P(GradientInvariance, ToTheBatchSize) {
    const Scene scene = small_scene(41, 31);
    const Image image = render(scene, {}, "gpt").image;
    for (const std::uint32_t batch_size : {64u, 300u, 1300u}) {
        RenderOptions options;
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options, "gpt").image)) << "batch size " << batch_size;
    }
}

/// Its samples count for pixels of other strips.
TEST(GradientInvarianceOfAFilter, WithNegativeLobesToTheBatchSize) {
    Scene scene = own_scene("cornell-box.xml", 21, 31);
    scene.settings.samples_per_pixel = 7;
    scene.film.filter = FilmSettings::Filter::mitchell;
    scene.film.filter_radius = 2;
    RenderOptions options;
    options.layers = true;
    const Image image = render(scene, options, "gpt").image;
    for (const std::uint32_t batch_size : {64u, 300u, 1300u}) {
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options, "gpt").image)) << "batch size " << batch_size;
    }
}

TEST_P(GradientInvariance, ToTheThreadsThatTrace) {
    const Scene scene = small_scene(48, 36);
    RenderOptions options;
    options.threads = 1;
    const Image image = render(scene, options, "gpt").image;
    options.threads = 3;
    EXPECT_TRUE(equal_bits(image, render(scene, options, "gpt").image));
    options.seed = 1;
    EXPECT_FALSE(equal_bits(image, render(scene, options, "gpt").image));
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientInvariance, ::testing::Values("cornell-box", "materials"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, GradientInvariance, ::testing::Values("plates"), name_of_scene);

/// Paths that meet nothing, or a mirror, gather nothing at their first vertices: what earlier passes left must be gone.
TEST(GradientEdges, BeginAnewWithEachPass) {
    SceneMaker maker(40, 4);
    maker.look({0, 1, 5}, {0, 0, 0}, 40);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5f)));
    maker.sphere({0, 0.5f, 0}, 0.4f, maker.material(mirror()));
    maker.point_light({5, 5, 5}, {1, 3, 2});
    RenderOptions options;
    const Image at_once = render(maker.scene, options, "gpt").image;
    options.batch_size = 64; // a pass for each sample
    EXPECT_TRUE(equal_bits(at_once, render(maker.scene, options, "gpt").image));
    const std::vector<float> &primal = at_once.find("primal.G")->values;
    EXPECT_EQ(primal.front(), 0);
    EXPECT_GT(*std::max_element(primal.begin(), primal.end()), 0);
}

/// Films without neighbours to one side or at all, no depth, black lights.
TEST(GradientEdges, HaveFiniteImages) {
    double not_finite = 0;
    for (const auto &[width, height] : {std::pair{1u, 1u}, {1u, 9u}, {9u, 1u}, {2u, 2u}})
        for (const int max_depth : {0, 1, 2, 3, -1}) {
            Scene scene = own_scene("cornell-box.xml", width, height);
            scene.settings.samples_per_pixel = 3;
            scene.settings.max_depth = max_depth;
            const Image image = render(scene, {}, "gpt").image; // fails where a value is not finite
            EXPECT_EQ(image.width, width);
            not_finite += double(count_non_finite(image));
        }
    record_stability({"Gradients", "films without neighbours: differences that do not exist",
                      "1 x 1, 1 x 9, 9 x 1 and 2 x 2 pixels, depths from 0", "those differences are left out",
                      "values that are not finite", not_finite, 0});
}

/// What the camera sees of a light is no part of the primal.
TEST(GradientDirect, HoldsTheLight) {
    Scene scene = own_scene("cornell-box.xml", 64, 64);
    scene.settings.samples_per_pixel = 4;
    scene.settings.max_depth = 1;
    const Image image = render(scene, {}, "gpt").image;
    EXPECT_EQ(spread_of(image, "primal.G").most, 0);
    EXPECT_EQ(spread_of(image, "dx.G").most, 0);
    EXPECT_GT(spread_of(image, "direct.G").most, 1);
    EXPECT_EQ(image.find("direct.G")->values, image.find("G")->values);
}

TEST(GradientOptions, NormAndAlphaAreTaken) {
    Scene scene = own_scene("cornell-box.xml", 48, 48);
    scene.settings.samples_per_pixel = 4;
    RenderOptions options;
    options.reconstruction = Reconstruction::l1;
    const Image l1 = render(scene, options, "gpt").image;
    options.alpha = 0.01;
    const Image small = render(scene, options, "gpt").image;
    options.reconstruction = Reconstruction::l2;
    const Image l2 = render(scene, options, "gpt").image;
    EXPECT_FALSE(equal_bits(l1, small));
    EXPECT_FALSE(equal_bits(l2, small));
    EXPECT_EQ(l1.find("primal.G")->values, l2.find("primal.G")->values);
    EXPECT_EQ(l1.find("dx.G")->values, l2.find("dx.G")->values);
}

} // namespace
} // namespace gradus::testing
