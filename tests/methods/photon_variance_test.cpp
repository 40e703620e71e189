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

} // namespace
} // namespace gradus::testing
