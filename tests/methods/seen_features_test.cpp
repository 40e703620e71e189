// Albedo, normal and depth as images have them: what the camera sees through mirrors, glass and holes.
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"

#include <cmath>
#include <string>

namespace gradus::testing {
namespace {

class SeenFeatures : public ::testing::TestWithParam<const char *> {
  protected:
    static constexpr std::uint32_t size = 16;

    /// A camera at z = 4 looks down at a surface at z = 0; six above that, where x < 0, hangs a wall of albedo 0.8.
    static Image image_with(const Bsdf &surface) { return render_of(surface, false).image; }
    /// `clipped`: with something before the camera, which its near plane hides.
    static Rendered render_of(const Bsdf &surface, bool clipped, std::uint64_t samples = 2) {
        SceneMaker maker(size, samples);
        maker.look({0, 0, 4}, {0, 0, 0}, 4);
        maker.parallelogram({-9, -9, 6}, {0, 18, 0}, {9, 0, 0}, maker.material(diffuse(0.8)));
        maker.parallelogram({-9, -9, -2}, {18, 0, 0}, {0, 18, 0}, maker.material(diffuse(0.3)));
        maker.parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(surface));
        maker.environment(1);
        // Out of sight: surfaces of all kinds here, so that all cases need the same kernels.
        Bsdf hole, pane;
        hole.kind = BsdfKind::null;
        pane.kind = BsdfKind::thindielectric;
        float left = 50;
        for (const Bsdf &hidden : {mirror(), rough_metal(0.3), hole, pane})
            maker.parallelogram({left++, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, maker.material(hidden));
        if (clipped) {
            maker.parallelogram({-1, -1, 3.5}, {0, 2, 0}, {2, 0, 0}, maker.material(diffuse(0.1)));
            maker.scene.camera.near_clip = 1;
        }
        RenderOptions options;
        options.aov = true;
        options.photons = 100;
        options.direct_photons = true; // `gather` in the place of `shade`
        return render(maker.scene, options, GetParam());
    }

    /// At the middles of the left and of the right half; rays are within two degrees of the axis.
    static void expect(const Image &image, bool right, double albedo, double normal, double depth) {
        const std::uint32_t x = right ? size * 3 / 4 : size / 4, y = size / 2;
        EXPECT_NEAR(pixel(image, x, y, "albedo.G"), albedo, 1e-6);
        EXPECT_NEAR(pixel(image, x, y, "normal.Z"), normal, 1e-6);
        EXPECT_NEAR(pixel(image, x, y, "depth.Z"), depth, 2e-3 * depth);
    }
};

TEST_P(SeenFeatures, AreThoseOfWhatAMirrorShows) {
    Bsdf tinted = mirror();
    tinted.specular_reflectance = {0.5f, 0.5f, 0.5f};
    const Image image = image_with(tinted);
    expect(image, false, 0.5 * 0.8, -1, 4 + 6); // the wall
    expect(image, true, 0.5, 1, 4);             // the sky has none, so the mirror's own
}

TEST_P(SeenFeatures, AreThoseOfWhatAHoleShows) {
    Bsdf hole;
    hole.kind = BsdfKind::null;
    expect(image_with(hole), true, 0.3, 1, 4 + 2);
}

TEST_P(SeenFeatures, AreThoseOfRoughSurfacesThemselves) {
    Bsdf tinted = rough_metal(0.3);
    tinted.specular_reflectance = {0.5f, 0.5f, 0.5f};
    expect(image_with(tinted), false, 0.5, 1, 4);
}

TEST_P(SeenFeatures, AreWeighedByTheLightThatALobeTakes) {
    Bsdf pane;
    pane.kind = BsdfKind::thindielectric;
    pane.ior = 1.5f;
    const double once = 0.04, reflected = 2 * once / (1 + once); // to and fro in the pane, at normal incidence
    // Chains of photon methods reflect an eighth of their paths.
    const Image image = render_of(pane, false, 256).image;
    const std::uint32_t x = size / 4, y = size / 2;
    EXPECT_NEAR(pixel(image, x, y, "albedo.G"), 0.3 + (0.8 - 0.3) * reflected, 5e-3);
    EXPECT_NEAR(pixel(image, x, y, "normal.Z"), 1 - 2 * reflected, 0.02);
    EXPECT_NEAR(pixel(image, x, y, "depth.Z"), 6 + 4 * reflected, 0.04);
}

TEST_P(SeenFeatures, CountTheWayFromTheCameraAndNotFromItsNearPlane) {
    expect(render_of(mirror(), true).image, true, 0.1, -1, 4 + 3.5); // what is hidden is seen in the mirror
    const Rendered clipped = render_of(rough_metal(0.3), true), plain = render_of(rough_metal(0.3), false);
    EXPECT_NEAR(pixel(clipped.image, size / 4, size / 2, "depth.Z"), 4, 8e-3);
    // So do the radii of photons.
    EXPECT_EQ(clipped.statistics.first_radii.points, plain.statistics.first_radii.points);
    EXPECT_NEAR(clipped.statistics.first_radii.sum, plain.statistics.first_radii.sum,
                1e-4 * plain.statistics.first_radii.sum);
}

/// Two mirrors, one above the other, between which the camera looks to and fro: below, above, below, and then at a wall
/// of albedo 0.8 at x = 15, which faces it. Ways fall or rise by 1 in 3.
SceneMaker corridor(const Bsdf &below, const Bsdf &above, std::uint32_t size, std::uint64_t samples) {
    SceneMaker maker(size, samples);
    maker.look({-3, 0, 1}, {0, 0, 0}, 1);
    maker.parallelogram({-1, -2, 0}, {20, 0, 0}, {0, 4, 0}, maker.material(below));
    maker.parallelogram({3, -2, 2}, {0, 4, 0}, {20, 0, 0}, maker.material(above));
    maker.parallelogram({15, -2, 0}, {0, 0, 2}, {0, 4, 0}, maker.material(diffuse(0.8)));
    maker.environment(1);
    return maker;
}
const double way_in_corridor = std::sqrt(10.0) / 3; // to where x is one more

Bsdf tinted_mirror(Rgb reflectance) {
    Bsdf tinted = mirror();
    tinted.specular_reflectance = reflectance;
    return tinted;
}

/// Of a pixel beside which there is none: no offset path follows.
TEST(SeenFeaturesOfGradients, HaveTheColourOfAllMirrorsWhereNoOffsetPathFollows) {
    const Bsdf tinted = tinted_mirror({0.9f, 0.6f, 0.3f});
    RenderOptions options;
    options.aov = true;
    do_not_weigh(options);
    const Image image = render(corridor(tinted, tinted, 1, 1).scene, options, "gpt").image;
    EXPECT_NEAR(pixel(image, 0, 0, "albedo.R"), 0.8 * 0.9 * 0.9 * 0.9, 1e-6);
    EXPECT_NEAR(pixel(image, 0, 0, "albedo.G"), 0.8 * 0.6 * 0.6 * 0.6, 1e-6);
    EXPECT_NEAR(pixel(image, 0, 0, "albedo.B"), 0.8 * 0.3 * 0.3 * 0.3, 1e-6);
}

class SeenFeaturesOfRoulette : public ::testing::TestWithParam<const char *> {
  protected:
    static constexpr std::uint32_t size = 16;

    static Image image_of(const Scene &scene) {
        RenderOptions options;
        options.aov = true;
        options.photons = 100;
        do_not_weigh(options);
        return render(scene, options, GetParam()).image;
    }
    static double mean(const Image &image, const char *channel) {
        double sum = 0;
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x)
                sum += pixel(image, x, y, channel);
        return sum / (size * size);
    }
};

/// Few paths come through the mirrors and count for all: what is seen is what no roulette shows.
TEST_P(SeenFeaturesOfRoulette, CountPathsThatSurviveForThoseThatDoNot) {
    constexpr double tint = 0.6;
    constexpr std::uint64_t samples = 64;
    const Bsdf tinted = tinted_mirror({float(tint), float(tint), float(tint)});
    SceneMaker maker = corridor(tinted, tinted, size, samples);
    maker.scene.settings.rr_depth = 1;
    const Image image = image_of(maker.scene);
    // A sample is 1 / p with probability p, at least tint^3, and else nothing: its variance is 1 / p - 1. Five standard
    // errors, 6e-7 by chance; strata only make it less.
    const double tolerance = 5 * std::sqrt((1 / std::pow(tint, 3) - 1) / double(size * size * samples));
    const double counted = -mean(image, "normal.X");
    EXPECT_NEAR(counted, 1, tolerance);
    // All features are of the same paths; pixels lie within half a degree, over which ways differ by 3 in 100 evenly.
    EXPECT_NEAR(mean(image, "albedo.G") / (0.8 * std::pow(tint, 3)), counted, 1e-4);
    EXPECT_NEAR(mean(image, "depth.Z") / (18 * way_in_corridor), counted, 2e-3);
    EXPECT_NEAR(mean(image, "normal.Z"), 0, 1e-4); // the mirrors' own
}

/// Where all is black, or paths end by their length, roulette has no say.
TEST_P(SeenFeaturesOfRoulette, AreOfTheFirstMirrorWhereAChainEndsByNoChance) {
    const auto expect_first = [](SceneMaker maker, int rr_depth, double albedo) {
        maker.scene.settings.rr_depth = rr_depth;
        const Image image = image_of(maker.scene);
        EXPECT_NEAR(mean(image, "albedo.G"), albedo, 1e-6);
        EXPECT_NEAR(mean(image, "normal.Z"), 1, 1e-6);
    };
    expect_first(corridor(tinted_mirror({0, 0, 0}), tinted_mirror({0, 0, 0}), size, 2), 1, 0);
    SceneMaker brief = corridor(tinted_mirror({0.8f, 0.8f, 0.8f}), tinted_mirror({0.8f, 0.8f, 0.8f}), size, 2);
    brief.scene.settings.max_depth = 2;
    expect_first(brief, 2, 0.8); // at the second mirror
}

INSTANTIATE_TEST_SUITE_P(Methods, SeenFeaturesOfRoulette, ::testing::Values("pt", "gpt", "sppm"), name_of_method);
INSTANTIATE_TEST_SUITE_P(Methods, SeenFeatures, ::testing::Values("pt", "sppm"), name_of_method);

} // namespace
} // namespace gradus::testing
