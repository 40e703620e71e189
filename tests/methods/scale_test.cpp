// Scenes of other sizes and far from the origin.
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/stability.h"

#include "runtime/scene/transform.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

/// Every position p becomes factor p + offset.
void place(Scene &scene, double factor, const Double3 &offset) {
    const auto placed = [&](Vector3 p) { return to_float(add(scale(to_double(p), factor), offset)); };
    for (Mesh &mesh : scene.meshes)
        for (Vector3 &p : mesh.positions)
            p = placed(p);
    for (Sphere &sphere : scene.spheres) {
        sphere.center = placed(sphere.center);
        sphere.radius = float(sphere.radius * factor);
    }
    for (int axis = 0; axis < 3; ++axis) {
        double &origin = scene.camera.to_world.m[std::size_t(axis) * 4 + 3];
        origin = factor * origin + offset[axis];
    }
}

double extent(const Scene &scene) {
    Double3 low{INFINITY, INFINITY, INFINITY}, high{-INFINITY, -INFINITY, -INFINITY};
    for (const Mesh &mesh : scene.meshes)
        for (const Vector3 &p : mesh.positions)
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = std::min(low[axis], to_double(p)[axis]);
                high[axis] = std::max(high[axis], to_double(p)[axis]);
            }
    return length(subtract(high, low));
}

constexpr const char *area = "Numbers";
constexpr const char *other_size = "scenes of another size: distances below any fixed epsilon, or areas out of range";
constexpr const char *far_away = "far from the origin positions lose the bits that the scene needs";
constexpr const char *offsets = "rays start off surfaces by what their coordinates' rounding takes; no epsilon for all "
                                "scenes";

/// The path tracer's image against the reference.
void expect_agreement(const ReferenceScene &reference, const char *failure, const std::string &provoked_by) {
    const std::vector<Image> images = render_seeds(reference.scene, 8);
    EXPECT_TRUE(agrees(images, 32, reference));
    record_stability({area, failure, provoked_by + ", path tracing", offsets,
                      "largest score of a block of 16 x 16 pixels over its limit", largest_score(images, 32, reference),
                      1});
}

class Scaled : public ::testing::TestWithParam<double> {};

TEST_P(Scaled, CornellBoxStaysAsItIs) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.name = fmt::format("cornell-box-times-{}", GetParam());
    place(reference.scene, GetParam(), {0, 0, 0});
    reference.scene.settings.samples_per_pixel = 32;
    expect_agreement(reference, other_size, fmt::format("scenes/cornell-box.xml times {}", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Numbers, Scaled, ::testing::Values(1e-3, 1e4));

/// The scene moved away from the origin by so many times its extent, along the diagonal.
ReferenceScene moved(double extents) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.name = fmt::format("cornell-box-{}-extents-away", extents);
    const double offset = extents * extent(reference.scene) / std::sqrt(3.0);
    place(reference.scene, 1, {offset, -offset, offset});
    reference.scene.settings.samples_per_pixel = 32;
    return reference;
}

class FarAway : public ::testing::TestWithParam<double> {};

TEST_P(FarAway, CornellBoxStaysAsItIs) {
    expect_agreement(moved(GetParam()), far_away,
                     fmt::format("scenes/cornell-box.xml {} times its extent from the origin", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Numbers, FarAway, ::testing::Values(10.0, 100.0));

// A float has 24 bits: at a thousand extents 14 are left for the scene itself, and rays start off surfaces by some
// thousandths of its extent. Corners and the edges of blocks show that; it is no more than stated here.
TEST(VeryFarAway, CornellBoxKeepsItsLight) {
    const ReferenceScene reference = moved(1000);
    const std::vector<Image> images = render_seeds(reference.scene, 8); // fails on values that are not finite
    const BlockTest blocks =
        block_z_test(images, reference.mean, reference.variance, 32, reference.samples_per_pixel, 16);
    ASSERT_EQ(blocks.non_finite, 0u);
    const std::size_t per_channel = blocks.z.size() / blocks.channels.size();
    double largest = 0;
    for (std::size_t i = 0; i < blocks.z.size(); ++i) {
        // Relative to the image's mean: dark blocks have little to lose.
        const double mean = spread_of(reference.mean, reference.mean.channels[i / per_channel].name).mean;
        largest = std::max(largest, std::fabs(blocks.difference[i]) / mean);
    }
    const double ratio = compare_means(mean_image(images), reference.mean).ratio;
    fmt::print("1000 extents away: mean ratio {:.4f}, largest error of a block {:.2f} % of the mean, |z| {:.1f}\n",
               ratio, 100 * largest, blocks.largest);
    EXPECT_NEAR(ratio, 1, 0.03);
    record_stability({area, far_away, "scenes/cornell-box.xml 1000 times its extent from the origin, path tracing",
                      "keeps its light; corners show that rays start some thousandths of the extent off surfaces",
                      "largest error of a block of 16 x 16 pixels, relative to the image's mean", largest, 0.1});
}

struct Placement {
    double factor, extents; ///< its size, and how many times that it is moved
};

class GradientsElsewhere : public ::testing::TestWithParam<Placement> {};

/// The very scene where it was is what the path tracer renders.
TEST_P(GradientsElsewhere, AreThoseOfTheSceneInPlace) {
    const auto [factor, extents] = GetParam();
    Scene scene = own_scene("cornell-box.xml", 32, 32), elsewhere = scene;
    const double offset = extents * extent(scene) / std::sqrt(3.0);
    place(elsewhere, factor, {offset, -offset, offset});
    expect_no_bias(
        gradient_bias(elsewhere, scene, {8, 16, 64}),
        {area, extents > 0 ? far_away : other_size,
         extents > 0
             ? fmt::format("scenes/cornell-box.xml {} times its extent from the origin, gradient-domain", extents)
             : fmt::format("scenes/cornell-box.xml times {}, gradient-domain", factor),
         offsets, 0.2});
}

INSTANTIATE_TEST_SUITE_P(Numbers, GradientsElsewhere,
                         ::testing::Values(Placement{1e-3, 0}, Placement{1e4, 0}, Placement{1, 10}, Placement{1, 100},
                                           Placement{1, 1000}));

} // namespace
} // namespace gradus::testing
