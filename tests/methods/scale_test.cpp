// Scenes of other sizes and far from the origin.
#include "runtime/scene/own_origin.h"
#include "runtime/scene/own_scale.h"
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/placed_scene.h"
#include "tests/support/render.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

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

constexpr std::uint64_t placed_samples = 8; // a pixel
constexpr const char *area = "Numbers";
constexpr const char *other_size = "scenes of another size: distances below any fixed epsilon, or areas out of range";
constexpr const char *far_away = "far from the origin positions lose the bits that the scene needs";
constexpr const char *offsets = "rays start off surfaces by what their coordinates' rounding takes; no epsilon for all "
                                "scenes";

/// The path tracer's image against the reference.
void expect_agreement(const ReferenceScene &reference, const char *failure, const std::string &provoked_by) {
    const std::vector<Image> images = render_seeds(reference.scene, 8);
    EXPECT_TRUE(agrees(images, double(placed_samples), reference));
    record_stability({area, failure, provoked_by + ", path tracing", offsets,
                      "largest score of a block of 16 x 16 pixels over its limit",
                      largest_score(images, double(placed_samples), reference), 1});
}

class Scaled : public ::testing::TestWithParam<double> {};

TEST_P(Scaled, CornellBoxStaysAsItIs) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.name = fmt::format("cornell-box-times-{}", GetParam());
    place(reference.scene, GetParam(), {0, 0, 0});
    reference.scene.settings.samples_per_pixel = placed_samples;
    expect_agreement(reference, other_size, fmt::format("scenes/cornell-box.xml times {}", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Numbers, Scaled, ::testing::Values(1e-3, 1e4));

// Past these areas' squares are no floats. Once such a scene was black, without a word.
class OwnScale : public ::testing::TestWithParam<double> {};

TEST_P(OwnScale, CornellBoxStaysAsItIs) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.name = fmt::format("cornell-box-times-{}", GetParam());
    place(reference.scene, GetParam(), {0, 0, 0});
    bring_to_own_scale(reference.scene);
    reference.scene.settings.samples_per_pixel = placed_samples;
    expect_agreement(reference, other_size, fmt::format("scenes/cornell-box.xml times {}", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Numbers, OwnScale, ::testing::Values(1e-10, 1e10));

/// The scene moved away from the origin by so many times its extent, along the diagonal.
ReferenceScene moved(double extents, std::uint64_t samples = placed_samples) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.name = fmt::format("cornell-box-{}-extents-away", extents);
    const double offset = extents * extent(reference.scene) / std::sqrt(3.0);
    place(reference.scene, 1, {offset, -offset, offset});
    reference.scene.settings.samples_per_pixel = samples;
    return reference;
}

class FarAway : public ::testing::TestWithParam<double> {};

TEST_P(FarAway, CornellBoxStaysAsItIs) {
    expect_agreement(moved(GetParam()), far_away,
                     fmt::format("scenes/cornell-box.xml {} times its extent from the origin", GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Numbers, FarAway, ::testing::Values(10.0, 100.0));

/// How far images are from a reference: means of blocks of 16 x 16 pixels.
struct BlockError {
    double mean_ratio, largest, root_mean_square; ///< errors relative to the channel's mean: dark blocks lose little
};

BlockError block_error(const std::vector<Image> &images, const ReferenceScene &reference) {
    const BlockTest blocks =
        block_z_test(images, reference.mean, reference.variance, double(reference.scene.settings.samples_per_pixel),
                     reference.samples_per_pixel, 16);
    EXPECT_EQ(blocks.non_finite, 0u);
    const std::size_t per_channel = blocks.z.size() / blocks.channels.size();
    BlockError error{compare_means(mean_image(images), reference.mean).ratio, 0, 0};
    for (std::size_t i = 0; i < blocks.z.size(); ++i) {
        const double mean = spread_of(reference.mean, reference.mean.channels[i / per_channel].name).mean;
        const double relative = std::fabs(blocks.difference[i]) / mean;
        error.largest = worse(error.largest, relative);
        error.root_mean_square += relative * relative / double(blocks.z.size());
    }
    error.root_mean_square = std::sqrt(error.root_mean_square);
    return error;
}

// A float has 24 bits: at a thousand extents 14 are left for the scene itself, and rays start off surfaces by some
// thousandths of its extent. Corners and the edges of blocks show that; it is no more than stated here.
TEST(VeryFarAway, CornellBoxKeepsItsLight) {
    const ReferenceScene reference = moved(1000, 2 * placed_samples);
    const std::vector<Image> images = render_seeds(reference.scene, 8); // fails on values that are not finite
    const BlockError error = block_error(images, reference);
    fmt::print("1000 extents away: mean ratio {:.4f}, largest error of a block {:.2f} % of the mean\n",
               error.mean_ratio, 100 * error.largest);
    EXPECT_NEAR(error.mean_ratio, 1, 0.03);
    record_stability({area, far_away, "scenes/cornell-box.xml 1000 times its extent from the origin, path tracing",
                      "keeps its light; corners show that rays start some thousandths of the extent off surfaces",
                      "largest error of a block of 16 x 16 pixels, relative to the image's mean", error.largest, 0.1});
}

// Where it is rendered: what is left is what the scene itself has lost, a corner off by a unit in the last place here
// and there.
TEST(OwnOrigin, CornellBoxStaysAsItIs) {
    ReferenceScene reference = moved(1000);
    bring_to_own_origin(reference.scene);
    expect_agreement(reference, far_away,
                     "scenes/cornell-box.xml 1000 times its extent from the origin, and brought there");
}

// Ten times further a float keeps eleven bits for the scene. In either precision vertices have these alone, and rays
// start off surfaces by some hundredths of the scene, since Embree takes origins in float. Only points on surfaces and
// what is computed from them are exact in double, so it gains little here; it must not lose.
TEST(FullVeryFarAway, DoubleIsNoWorseThanFloat) {
    if (!shared_device().description().has_double)
        GTEST_SKIP() << shared_device().description().name << " has no double precision";
    const ReferenceScene reference = moved(10'000, 2 * placed_samples);
    RenderOptions options;
    const std::vector<Image> single = render_seeds(reference.scene, 8, options);
    options.precision = Precision::double_;
    const std::vector<Image> wide = render_seeds(reference.scene, 8, options);
    std::vector<double> excess; // of double's relMSE over float's, seed by seed
    for (std::size_t i = 0; i < single.size(); ++i)
        excess.push_back(relative_mse(wide[i], reference.mean) - relative_mse(single[i], reference.mean));
    const Spread spread = spread_of(excess);
    for (const auto &[name, images] : {std::pair{"single", &single}, std::pair{"double", &wide}}) {
        const BlockError error = block_error(*images, reference);
        fmt::print("10000 extents away, {}: mean ratio {:.4f}, error of a block: root mean square {:.2f} %, largest "
                   "{:.2f} % of the mean, relMSE of the mean {:.2e}\n",
                   name, error.mean_ratio, 100 * error.root_mean_square, 100 * error.largest,
                   relative_mse(mean_image(*images), reference.mean));
    }
    fmt::print("relMSE of double less that of float: {:.2e} +- {:.2e}\n", spread.mean, spread.standard_error);
    EXPECT_LE(spread.mean, 4 * spread.standard_error);
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
        gradient_bias(elsewhere, scene, {8, 8, 32}),
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
