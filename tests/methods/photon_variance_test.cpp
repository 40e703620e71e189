// The variances that images of photon methods tell of themselves, against the spread of images of other seeds.
#include "tests/methods/variance_check.h"

namespace gradus::testing {
namespace {

/// The floor under the lamp with a wall behind it, of which photons bring its light.
Scene lit_corner() {
    Scene scene = smooth_wall(16);
    scene.settings.max_depth = 3;
    SceneMaker maker(wall_side, 16);
    maker.scene = scene;
    maker.parallelogram({-2, 0, 2.2f}, {0, 2, 0}, {4, 0, 0}, maker.material(diffuse(0.7)));
    return maker.scene;
}

TEST(PhotonVariances, AreThoseOfOtherSeeds) {
    RenderOptions options = with_aov();
    options.photons = 500;
    const std::vector<Image> images = render_seeds(lit_corner(), 16, options, 1, "sppm");
    expect_right(told_over_true(images, "", "variance"), 0.5, "sppm");
}

TEST(FullPhotonVariances, AreThoseOfOtherSeeds) {
    RenderOptions options = with_aov();
    options.photons = 500;
    const std::vector<Image> images = render_seeds(lit_corner(), 128, options, 1, "sppm");
    expect_right(told_over_true(images, "", "variance"), 0.2, "sppm");
}

/// Photons are those of all pixels of a pass, so that their noise is alike in neighbours.
TEST(FullPhotonVariances, OfGradientsAreThoseOfOtherSeeds) {
    RenderOptions options = with_aov();
    options.photons = 500;
    const std::vector<Image> images = render_seeds(lit_corner(), 64, options, 1, "gpm");
    expect_right(told_over_true(images, "primal", "variance"), 0.6, "gpm: the mean");
    for (const char *layer : {"primal", "dx", "dy"})
        expect_right(told_over_true(images, layer, std::string(layer) + "_variance", 1), 0.6,
                     std::string("gpm: ") + layer);
}

} // namespace
} // namespace gradus::testing
