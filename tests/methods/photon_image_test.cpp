// Images of photon mapping: in closed form, and against path tracing.
#include "methods/photon_mapper.h"
#include "runtime/error.h"
#include "runtime/scene/traits.h"
#include "tests/methods/photon_case.h"
#include "tests/methods/photon_scenes.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <numbers>

namespace gradus::testing {
namespace {

constexpr double pi = std::numbers::pi;

class PhotonFurnace : public ::testing::TestWithParam<bool> {};

TEST_P(PhotonFurnace, IsAsBrightEverywhereAsItIs) {
    RenderOptions options = with_radius(0.05, true, 0.9);
    options.direct_photons = GetParam();
    options.photons = 20'000;
    std::vector<double> means;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        options.seed = seed;
        means.push_back(spread_of(render(furnace(diffuse(0.5), 4), options, "sppm").image).mean);
    }
    const Spread spread = spread_of(means);
    fmt::print("{}: {:.5f} +- {:.5f}\n", GetParam() ? "photons" : "sampling", spread.mean, spread.standard_error);
    // 5.4 standard errors of 8 seeds: Student's t exceeds that once in a thousand tests.
    EXPECT_NEAR(spread.mean, 2, 5.4 * spread.standard_error);
    EXPECT_LT(spread.standard_error, 0.01) << "too noisy to tell";
}

INSTANTIATE_TEST_SUITE_P(Photons, PhotonFurnace, ::testing::Bool(),
                         [](const auto &info) { return info.param ? "Photons" : "Sampling"; });

/// A floor under a point light, seen from above, with the light's irradiance in closed form.
struct LitFloor {
    double height = 1, extent = 4; ///< of the light; of the floor, from the middle
    std::uint32_t size = 32;
    Scene scene(std::uint64_t passes) const {
        SceneMaker maker(size, passes);
        maker.look({0, 6, 0}, {0, 0, 0}, 30, {0, 0, 1});
        maker.floor(float(-extent), float(extent), float(extent), maker.material(diffuse(1)));
        maker.point_light({float(pi), float(pi), float(pi)}, {0, float(height), 0});
        maker.scene.settings.max_depth = 2;
        return maker.scene;
    }
    /// Radiance of the floor at a distance from the point below the light: E / pi.
    double radiance(double distance) const {
        const double squared = distance * distance + height * height;
        return height / (squared * std::sqrt(squared));
    }
    /// Its mean over a disc of this radius.
    double blurred(double distance, double radius) const {
        constexpr int rings = 24, spokes = 24;
        double sum = 0;
        for (int i = 0; i < rings; ++i) // of equal areas
            for (int j = 0; j < spokes; ++j) {
                const double r = radius * std::sqrt((i + 0.5) / rings), angle = 2 * pi * (j + 0.5) / spokes;
                sum += radiance(std::hypot(distance + r * std::cos(angle), r * std::sin(angle)));
            }
        return sum / (rings * spokes);
    }
    /// Of the middle of a pixel from the point below the light.
    double distance(std::uint32_t x, std::uint32_t y) const {
        const double edge = 2 * 6 * std::tan(15 * pi / 180) / size;
        return std::hypot((x + 0.5 - size / 2.0) * edge, (y + 0.5 - size / 2.0) * edge);
    }
    /// The mean over the pixels of the middle 8 x 8, which are at y = 0.
    double middle(double radius) const {
        double sum = 0;
        const double half = 6 * std::tan(15 * pi / 180);
        constexpr int steps = 4;
        const int side = 8 * steps;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const auto place = [&](int i) { return ((i + 0.5) / steps - 4) * 2 * half / size; };
                const double distance = std::hypot(place(x), place(y));
                sum += radius > 0 ? blurred(distance, radius) : radiance(distance);
            }
        return sum / (side * side);
    }
};

double mean_of_middle(const Image &image, const char *channel = "G") {
    double sum = 0;
    const std::uint32_t from = image.width / 2 - 4;
    for (std::uint32_t y = from; y < from + 8; ++y)
        for (std::uint32_t x = from; x < from + 8; ++x)
            sum += pixel(image, x, y, channel) / 64;
    return sum;
}

// The estimate is the mean of the irradiance over the disc: its error is known, and grows with the square of the
// radius.
TEST(PhotonBias, OnASmoothFloorIsThatOfTheDiscAndGoesWithItsArea) {
    const LitFloor floor;
    const double diameter = 1.01 * std::sqrt(2.0) * 2 * floor.extent; // SceneTables::scene_diameter
    double bias[3];
    const double radii[3] = {0.1, 0.2, 0.4};
    for (int i = 0; i < 3; ++i) {
        RenderOptions options = with_radius(radii[i] / diameter, true);
        options.direct_photons = true;
        options.photons = 400'000;
        std::vector<double> means;
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            options.seed = seed;
            means.push_back(mean_of_middle(render(floor.scene(1), options, "sppm").image));
        }
        const Spread spread = spread_of(means);
        const double expected = floor.middle(radii[i]), exact = floor.middle(0);
        bias[i] = spread.mean / exact - 1;
        fmt::print("radius {}: {:.5f} +- {:.5f}, expected {:.5f}, exact {:.5f}\n", radii[i], spread.mean,
                   spread.standard_error, expected, exact);
        // 6.9 standard errors of 6 seeds: Student's t exceeds that once in a thousand tests; and `middle`'s quadrature.
        EXPECT_NEAR(spread.mean, expected, 6.9 * spread.standard_error + 2e-4 * exact);
        EXPECT_LT(spread.standard_error, 0.003 * exact) << "too noisy to tell";
    }
    fmt::print("bias {:.4f}, {:.4f}, {:.4f}\n", bias[0], bias[1], bias[2]);
    EXPECT_LT(bias[2], 0);
    EXPECT_NEAR(std::log2(bias[2] / bias[1]), 2, 0.35); // less at radii near the light's height: 0.16 for this one
}

// What images with layers say of their bias, and of its square, is as the discs have it: twice what a disc differs from
// the inner half of its area, which is the bias but for what goes with the fourth power of the radius.
TEST(PhotonBias, IsToldFromTheSamePhotons) {
    const LitFloor floor;
    const double radius = 0.5, diameter = 1.01 * std::sqrt(2.0) * 2 * floor.extent;
    RenderOptions options = with_radius(radius / diameter, true);
    options.direct_photons = options.aov = true;
    options.photons = 25'000;
    std::vector<double> found[2], squares[2];
    for (const bool is_weighed : {false, true})
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            Scene scene = floor.scene(4);
            if (is_weighed) { // four samples weigh more or less than four
                scene.film.filter = FilmSettings::Filter::lanczos;
                scene.film.filter_radius = 3;
            }
            options.variance = !is_weighed; // with and without replicates
            options.seed = seed;
            const Rendered rendered = render(scene, options, "sppm");
            found[is_weighed].push_back(mean_of_middle(rendered.image, "bias.G"));
            squares[is_weighed].push_back(rendered.statistics.relative_squared_bias.value_or(NAN));
        }
    const double expected = 2 * (floor.middle(radius) - floor.middle(radius / std::sqrt(2.0)));
    const double bias = floor.middle(radius) - floor.middle(0);
    double square = 0;
    for (std::uint32_t y = 0; y < floor.size; ++y)
        for (std::uint32_t x = 0; x < floor.size; ++x) {
            const double distance = floor.distance(x, y), seen = floor.blurred(distance, radius);
            square += std::pow(2 * (seen - floor.blurred(distance, radius / std::sqrt(2.0))), 2) /
                      (seen * seen + relative_mse_epsilon) / (floor.size * floor.size);
        }
    for (const bool is_weighed : {false, true}) {
        const Spread spread = spread_of(found[is_weighed]), of_squares = spread_of(squares[is_weighed]);
        fmt::print("bias {:.5f} +- {:.5f}, expected {:.5f}, that of the discs {:.5f}; its square {:.3g} +- {:.2g}, "
                   "expected {:.3g}\n",
                   spread.mean, spread.standard_error, expected, bias, of_squares.mean, of_squares.standard_error,
                   square);
        // 6.9 standard errors of 6 seeds, as above, and the quadratures'.
        EXPECT_NEAR(spread.mean, expected, 6.9 * spread.standard_error + 2e-4);
        EXPECT_NEAR(of_squares.mean, square, 6.9 * of_squares.standard_error + 0.01 * square);
        EXPECT_LT(6.9 * spread.standard_error, 0.15 * std::fabs(expected)) << "too noisy to tell";
        EXPECT_LT(6.9 * of_squares.standard_error, 0.8 * square) << "too noisy to tell";
    }
    EXPECT_NEAR(expected, bias, 0.1 * std::fabs(bias));
}

// Beyond the border of a floor there are no photons: the bias is half of the light there, in a strip as wide as the
// radius, so all the light that is lost goes with the radius.
TEST(PhotonBias, AtTheBorderGoesWithTheRadius) {
    SceneMaker maker(48, 1);
    maker.look({0, 6, 0}, {0, 0, 0}, 30, {0, 0, 1});
    maker.floor(-1, 1, 1, maker.material(diffuse(1)));
    maker.directional_light({float(pi), float(pi), float(pi)}, {0, -1, 0});
    maker.scene.settings.max_depth = 2;
    const double diameter = 1.01 * std::sqrt(2.0) * 2;
    const double full = spread_of(render(maker.scene, {}, "pt").image).mean;
    double lost[2];
    for (int i = 0; i < 2; ++i) {
        const double radius = i == 0 ? 0.1 : 0.2;
        RenderOptions options = with_radius(radius / diameter, true);
        options.direct_photons = true;
        options.photons = 100'000;
        std::vector<double> means;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            options.seed = seed;
            means.push_back(spread_of(render(maker.scene, options, "sppm").image).mean);
        }
        lost[i] = 1 - spread_of(means).mean / full;
        // A half-plane's disc at a distance x within it: the share beyond it, over x from 0 to r, is 2 / (3 pi) r in
        // all. The square has a border of 8 on an area of 4; its corners lose a little less than twice.
        const double expected = 2 / (3 * pi) * radius * 8 / 4;
        fmt::print("radius {}: lost {:.4f} +- {:.4f}, about {:.4f}\n", radius, lost[i],
                   spread_of(means).standard_error / full, expected);
        EXPECT_NEAR(lost[i], expected, 0.15 * expected);
    }
    EXPECT_NEAR(std::log2(lost[1] / lost[0]), 1, 0.15);
}

// Nor are they traced for the light of surfaces that lights see, which camera paths sample.
TEST(PhotonImage, LightPathsThatLeaveNoPhotonAreNotTraced) {
    Scene scene = own_scene("cornell-box.xml", 16, 12);
    scene.settings.samples_per_pixel = 1;
    for (const char *method : {"sppm", "gpm"})
        for (const int depth : {1, 2, 3})
            for (const bool direct : {false, true}) {
                scene.settings.max_depth = depth;
                RenderOptions options = with_radius(1, false);
                options.direct_photons = direct;
                const bool leave_some = depth > (direct ? 1 : 2);
                EXPECT_EQ(render(scene, options, method).statistics.light_paths > 0, leave_some)
                    << method << ", depth " << depth << ", direct by " << (direct ? "photons" : "sampling");
            }
}

// With paths of so many edges at most, each kind of path by one estimator and none by two: whole images of both methods
// are the same but for the bias, which the radius keeps small. A kind that is missing or counted twice would be some
// percents of what its length adds.
class PathKinds : public ::testing::TestWithParam<const char *> {};

TEST_P(PathKinds, AreMadeOnceEach) {
    const std::string name = GetParam();
    double before = 0;
    for (const int depth : {1, 2, 3, 4, 7}) {
        Scene scene = own_scene(name + ".xml", 64, 48);
        scene.settings.max_depth = depth;
        // What lights of no extent send through glass and mirrors photons find, and camera paths cannot.
        std::erase_if(scene.emitters, [](const Emitter &emitter) {
            return emitter.kind == Emitter::Kind::point || emitter.kind == Emitter::Kind::directional ||
                   emitter.kind == Emitter::Kind::spot;
        });
        RenderOptions options = with_radius(1, false);
        // The camera paths are most of the noise, and in the torus photons are.
        options.photons = name == "torus-rough-glass" ? 150'000 : is_full() ? 50'000 : 20'000;
        const auto mean = [&](const char *method, std::uint64_t samples) {
            scene.settings.samples_per_pixel = samples;
            std::vector<double> means;
            for (const Image &image : render_seeds(scene, 6, options, 1, method))
                means.push_back(spread_of(image).mean);
            return spread_of(means);
        };
        const Spread expected = mean("pt", is_full() ? 128 : 16);
        const double added = expected.mean - before;
        for (const bool direct : {false, true}) {
            options.direct_photons = direct;
            const Spread found = mean("sppm", is_full() ? 8 : 4);
            const double error = std::hypot(expected.standard_error, found.standard_error);
            fmt::print("{}, direct by {}, depth {}: sppm {:.5f} +- {:.5f}, pt {:.5f} +- {:.5f}, added by it {:.5f}\n",
                       name, direct ? "photons" : "sampling", depth, found.mean, found.standard_error, expected.mean,
                       expected.standard_error, added);
            // 6 standard errors of some 10 degrees of freedom; 1.5 % for what borders and corners lose at this radius.
            EXPECT_NEAR(found.mean, expected.mean, 6 * error + 0.015 * expected.mean) << "depth " << depth;
        }
        before = expected.mean;
    }
}

INSTANTIATE_TEST_SUITE_P(Photons, PathKinds, ::testing::Values("cornell-box"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, PathKinds, ::testing::Values("torus-rough-glass", "materials", "plates"), name_of_scene);

// A floor seen in a mirror: both edges of the camera path count, and the photon's.
TEST(PathLength, CountsBothSides) {
    SceneMaker maker(8, 1);
    maker.look({0, 1, -3}, {0, 1, 0}, 20);
    maker.parallelogram({-2, 0, 0}, {0, 3, -1}, {4, 0, 0}, maker.material(mirror()));
    maker.floor(-4, 4, 8, maker.material(diffuse(0.8)), -0.5f);
    maker.point_light({5, 5, 5}, {0, 3, -3});
    RenderOptions options;
    options.photons = 50'000;
    for (const bool direct : {false, true}) {
        options.direct_photons = direct;
        maker.scene.settings.max_depth = 2;
        EXPECT_EQ(spread_of(render(maker.scene, options, "sppm").image).most, 0);
        maker.scene.settings.max_depth = 3;
        EXPECT_GT(spread_of(render(maker.scene, options, "sppm").image).mean, 0);
    }
}

// Of an index near 1, which rough glass hardly scatters what passes: a lobe that next to no photons fall into. Lamp and
// camera see a floor through a block of it, so camera paths and light paths both have to pass it.
TEST(NearlyClearGlass, IsPassedByCameraAndLightPathsHoweverRough) {
    Bsdf principled = rough_glass(0.36, 1.002);
    principled.kind = BsdfKind::principled_clear;
    principled.reflectance = {1, 1, 1};
    principled.roughness = 0.6f;
    principled.spec_trans = 1;
    for (const Bsdf &bsdf : {rough_glass(0.377, 1.002), principled}) {
        SceneMaker maker(12, 32);
        maker.look({0, 0.8, -2.5}, {0, 0.2, 0}, 18);
        maker.scene.settings.max_depth = 10;
        const std::uint32_t white = maker.material(diffuse(0.8));
        maker.floor(-2, 2, 2, white);
        maker.lamp({0, 3, 0}, 1.5f, 1.5f, 10, white);
        add_glass(maker, "a block", maker.material(bsdf));
        RenderOptions options = with_radius(1, false);
        options.photons = 20'000;
        options.reconstruction = Reconstruction::l2; // which keeps the mean
        const auto mean = [&](const char *method, std::uint64_t samples) {
            maker.scene.settings.samples_per_pixel = samples;
            std::vector<double> means;
            for (const Image &image : render_seeds(maker.scene, 6, options, 1, method))
                means.push_back(spread_of(image).mean);
            return spread_of(means);
        };
        const Spread expected = mean("pt", 256);
        for (const char *method : {"sppm", "gpm"}) {
            const Spread found = mean(method, 8);
            const double error = std::hypot(expected.standard_error, found.standard_error);
            fmt::print("{}, {}: {:.5f} +- {:.5f}, pt {:.5f} +- {:.5f}\n", bsdf_kind_name(bsdf), method, found.mean,
                       found.standard_error, expected.mean, expected.standard_error);
            // As of PathKinds, without the bias at corners.
            EXPECT_NEAR(found.mean, expected.mean, 6 * error + 0.005 * expected.mean) << method;
            EXPECT_LT(error, 0.01 * expected.mean) << "too noisy to tell";
        }
    }
}

TEST(PhotonRadius, ShrinksByTheRule) {
    double product = 1;
    for (int pass = 0; pass < 50; ++pass) {
        EXPECT_NEAR(radius_shrinkage(std::uint64_t(pass), 0.7), product, 1e-12);
        product *= (pass + 1 + 0.7) / (pass + 2);
    }
    EXPECT_NEAR(radius_shrinkage(1000, 1), 1, 1e-9);
    // It falls as pass^(alpha - 1).
    EXPECT_NEAR(std::log10(radius_shrinkage(1'000'000, 0.9) / radius_shrinkage(100'000, 0.9)), -0.1, 1e-3);
}

std::string error_of(const Scene &scene, const RenderOptions &options) {
    try {
        render(scene, options, "sppm");
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::usage);
        return error.what();
    }
    return "";
}

TEST(PhotonErrors, SayWhatIsMissing) {
    SceneMaker maker(8, 1);
    maker.look({0, 0, -3}, {0, 0, 0}, 40);
    maker.sphere({0, 0, 0}, 1, maker.material(rough_metal(0.04)));
    maker.environment(1);
    EXPECT_THAT(error_of(maker.scene, {}), ::testing::HasSubstr("no surface is rough enough"));
    RenderOptions rougher;
    rougher.gather_roughness = 0.03;
    rougher.photons = 1000;
    EXPECT_EQ(error_of(maker.scene, rougher), "");
    Scene dark = maker.scene;
    dark.emitters.clear();
    EXPECT_THAT(error_of(dark, rougher), ::testing::HasSubstr("no light"));
    RenderOptions bad = rougher;
    bad.radius = RenderOptions::GatherRadius{0, false};
    EXPECT_THAT(error_of(maker.scene, bad), ::testing::HasSubstr("radius"));
    bad = rougher;
    bad.radius_alpha = 0;
    EXPECT_THAT(error_of(maker.scene, bad), ::testing::HasSubstr("alpha"));
}

// One light path a pass, and paths of no length.
TEST(FewPhotons, AreEnough) {
    Scene scene = own_scene("cornell-box.xml", 32, 24);
    scene.settings.samples_per_pixel = 3;
    RenderOptions options;
    options.photons = 1;
    for (const bool direct : {false, true}) {
        options.direct_photons = direct;
        EXPECT_EQ(render(scene, options, "sppm").statistics.light_paths, 3u);
    }
    scene.settings.max_depth = 0;
    EXPECT_EQ(spread_of(render(scene, options, "sppm").image).most, 0);
}

} // namespace
} // namespace gradus::testing
