// Photon mapping where it is at its worst: for each case a small scene whose light is known, or found by path tracing.
#include "methods/photons/pass_photons.h"
#include "tests/methods/photon_case.h"
#include "tests/methods/photon_scenes.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/placed_scene.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gradus::testing {
namespace {

constexpr double pi = std::numbers::pi;
constexpr const char *area = "Photons";
constexpr const char *bias_at_most = "bias of the mean at most";
constexpr std::size_t seeds = 8;

/// Of the images of several seeds.
Spread means_of(const Scene &scene, RenderOptions options, const char *method = "sppm") {
    std::vector<double> means;
    for (const Image &image : render_seeds(scene, seeds, options, 1, method))
        means.push_back(spread_of(image).mean);
    return spread_of(means);
}

/// What the test cannot exclude: the difference and four standard errors, relative to what is expected.
double largest_bias(const Spread &found, const Spread &expected) {
    const double error = std::hypot(found.standard_error, expected.standard_error);
    const double bias = found.mean / expected.mean - 1;
    fmt::print("found {:.5f} +- {:.5f}, expected {:.5f} +- {:.5f}, bias {:.4f}\n", found.mean, found.standard_error,
               expected.mean, expected.standard_error, bias);
    return std::fabs(bias) + 4 * error / expected.mean;
}

Spread exactly(double value) {
    Spread spread;
    spread.mean = value;
    spread.standard_error = 0;
    return spread;
}

TEST(PhotonStability, OnMetalJustRoughEnough) {
    RenderOptions options = with_radius(0.02, true);
    options.photons = 50'000;
    options.direct_photons = true;
    for (const double roughness : {0.05, 0.1}) {
        Scene scene = furnace(rough_metal(roughness), 4);
        scene.settings.max_depth = 4;
        Scene traced = scene;
        traced.settings.samples_per_pixel = 16;
        record_stability(
            {area, "gathering on glossy surfaces: few of the photons within the radius are in the lobe",
             fmt::format("a closed sphere of metal of roughness {}, direct light by photons too", roughness),
             "the BSDF of each photon is evaluated; noisy, but as bright as path tracing has it", bias_at_most,
             largest_bias(means_of(scene, options), means_of(traced, {}, "pt")), 0.05});
    }
}

/// What floors are made of: materials of a scene's parts.
struct FloorParts {
    Scene scene;
    Material plain, mask, textured_mask, blend;
};

/// A mask of opacity 0.25, as a number and as a texture, and a blend of a diffuse part with a mirror that reflects
/// nothing.
FloorParts floor_parts() {
    FloorParts parts;
    parts.scene.textures.resize(1);
    Texture &checks = parts.scene.textures[0];
    checks.kind = Texture::Kind::checkerboard;
    checks.color_0 = {0.2f, 0.2f, 0.2f};
    checks.color_1 = {0.3f, 0.3f, 0.3f};
    checks.to_uv = {40, 0, 0, 0, 40, 0};
    Bsdf black = mirror(), blend;
    black.specular_reflectance = {0, 0, 0};
    parts.scene.blended = {diffuse(0.5), black};
    parts.scene.blends = {{0, 1, 0.5f}};
    blend.blend = 0;
    parts.blend = material_of(blend);
    parts.plain = parts.mask = material_of(diffuse(0.5));
    parts.mask.opacity = 0.25f;
    parts.textured_mask = parts.mask;
    parts.textured_mask.opacity.texture = 0;
    return parts;
}

/// A floor under a lamp, whose light is found by photons alone: the mean of its image. All parts lie on the lamp's
/// back, where there is no light, so that all floors have the same kernels.
double light_of_floor(const FloorParts &parts, const Material &material, const char *method) {
    SceneMaker maker(16, 16);
    maker.scene.textures = parts.scene.textures;
    maker.scene.blended = parts.scene.blended;
    maker.scene.blends = parts.scene.blends;
    maker.floor(-4, 4, 4, maker.material(material));
    maker.lamp({0, 3, 0}, 4, 4, 1, maker.material(diffuse(0)));
    for (const Material &hidden : {parts.plain, parts.mask, parts.textured_mask, parts.blend})
        maker.floor(-0.1f, 0.1f, 0.1f, maker.material(hidden), 3.1f);
    maker.look({0, 1, -1}, {0, 0, 0}, 40);
    maker.scene.settings.max_depth = 2;
    RenderOptions options = with_radius(0.03, true); // the floor is lit evenly
    options.direct_photons = true;
    options.photons = 50'000;
    options.reconstruction = Reconstruction::l2;
    return spread_of(render(maker.scene, options, method).image).mean;
}

// A mask of opacity 0.25 is met by a quarter of the photons and of the camera paths: 0.25 of the light, and not a
// sixteenth.
TEST(PhotonStability, OnMasks) {
    const FloorParts parts = floor_parts();
    double off = 0;
    for (const char *method : {"sppm", "gpm"}) {
        const double light = light_of_floor(parts, parts.plain, method);
        for (const Material &mask : {parts.mask, parts.textured_mask})
            off = worse(off, std::fabs(light_of_floor(parts, mask, method) / light / 0.25 - 1));
    }
    record_stability({area, "what is met by chance: photons and camera paths each meet a mask with its opacity",
                      "a floor of opacity 0.25, as a number and as a texture, sppm and gpm",
                      "photons at a gather point count one over its opacity", "relative error of the light", off,
                      0.04});
}

// The same of a blend, half of which is a mirror that reflects nothing.
TEST(PhotonStability, OnBlends) {
    const FloorParts parts = floor_parts();
    const double light = light_of_floor(parts, parts.plain, "sppm");
    record_stability({area, "what is met by chance: light and camera paths each draw a part of a blend",
                      "a floor of half a mirror and half a diffuse part, sppm",
                      "photons are kept wherever a part gathers, whichever part the light path draws",
                      "relative error of the light",
                      std::fabs(light_of_floor(parts, parts.blend, "sppm") / light / 0.5 - 1), 0.04});
}

// The radius goes by the pass and not by the photons that a pixel has seen, so there is nothing that few of them bias.
TEST(PhotonStability, WhereFewPhotonsAreSeen) {
    RenderOptions options = with_radius(0.005, true);
    options.photons = 2000;
    const Scene scene = furnace(diffuse(0.5), 4, 32);
    const Statistics statistics = render(scene, options, "sppm").statistics;
    EXPECT_LT(double(statistics.photon_pairs), 0.3 * double(statistics.gather_points)) << "they are not few";
    record_stability({area, "few photons seen: estimates that go by their number are biased",
                      "a furnace, one photon for five gather points", "the radius does not go by their number",
                      bias_at_most, largest_bias(means_of(scene, options), exactly(2)), 0.05});
}

TEST(PhotonStability, OfOneLightPathAPass) {
    RenderOptions options = with_radius(0.1, true);
    options.photons = 1;
    options.direct_photons = true;
    const Scene scene = furnace(diffuse(0.5), 600, 8);
    record_stability({area, "one light path a pass", "a furnace, 4800 passes in all", "is as bright as it is",
                      bias_at_most, largest_bias(means_of(scene, options), exactly(2)), 0.1});
}

TEST(PhotonStability, AtTheLimitsOfTheRadius) {
    std::size_t wrong = 0;
    for (const double value : {1e-30, 1e-9, 1e3, 1e18, 1e30})
        for (const bool of_scene : {false, true})
            for (const bool direct : {false, true}) {
                RenderOptions options = with_radius(value, of_scene);
                options.direct_photons = direct;
                options.photons = 200;
                const Image image = render(furnace(diffuse(0.5), 1, 8), options, "sppm").image;
                for (const float radiance : image.find("G")->values)
                    wrong += std::isfinite(radiance) && radiance >= 1 && radiance < 1e9 ? 0 : 1;
            }
    record_stability({area, "a radius that vanishes or overflows when it is squared",
                      "a furnace, radii from 1e-30 to 1e30 pixels or diameters",
                      "at least what positions are exact to; in pixels a twentieth of the scene at most",
                      "pixels that are not finite or darker than what the surface emits", double(wrong), 0});
}

// In a furnace of a cube the disc loses what lies beyond its wall: of a square of side s, seen as a whole, the mean
// over the disc of (s - |x|)(s - |y|) / s^2 is left, which is 1 - 8 r / (3 pi s) + r^2 / (2 pi s^2).
TEST(PhotonStability, InCorners) {
    SceneMaker maker(16, 2);
    maker.look({0, 0, 0}, {0, 0, 1}, 90);
    maker.scene.settings.rr_depth = 5;
    maker.cube(maker.material(diffuse(0.5)), maker.emitter(Emitter::Kind::area, {1, 1, 1}), true);
    const double diameter = 1.01 * std::sqrt(3.0) * 2, radius = 0.5, side = 2;
    const double lost = 8 * radius / (3 * pi * side) - radius * radius / (2 * pi * side * side);
    for (const bool direct : {false, true}) {
        RenderOptions options = with_radius(radius / diameter, true);
        options.photons = 50'000;
        options.direct_photons = direct;
        const double by_photons = direct ? 1 : 0.5;
        const Spread found = means_of(maker.scene, options), expected = exactly(2 - by_photons * lost);
        record_stability({area, "corners: the disc reaches beyond the wall, and to the next one",
                          direct ? "a cubic furnace, radius a quarter of its side, direct light by photons too"
                                 : "a cubic furnace, radius a quarter of its side",
                          "darkens by what of the disc is beyond the wall, and takes nothing from the next one",
                          "deviation from that at most, relative to it",
                          largest_bias(found, expected) * expected.mean / (by_photons * lost), 0.15});
    }
}

TEST(PhotonStability, AtThinWalls) {
    float brightest = 0;
    const double diameter = 1.01 * std::sqrt(3.0) * 2;
    const std::pair<double, double> walls[] = {{0, 0.01}, {0.001, 0.01}, {0.005, 0.17}}; // thickness, radius
    for (const auto &[between, radius] : walls)
        for (const bool both_sides : {false, true})
            for (const bool direct : {false, true}) {
                RenderOptions options = with_radius(radius / diameter, true);
                options.photons = 10'000;
                options.direct_photons = direct;
                const Rendered outside = render(thin_walls(between, both_sides), options, "sppm");
                for (const char *channel : {"R", "G", "B"})
                    for (const float value : outside.image.find(channel)->values)
                        brightest = std::max(brightest, value);
                EXPECT_GT(outside.statistics.gather_points, 100u);
            }
    record_stability({area, "thin walls: light of the other side is gathered",
                      "a lit box with walls of 0, 1 and 5 mm, one- and two-sided, radius 10, 10 and 170 mm",
                      "photons count where their surface faces the same way", "largest value outside", brightest, 0});
}

// No bias by a disc on a sphere: the part of it within the radius has the area of the disc. So pixels at the silhouette
// are as path tracing has them, partly ball and partly sky.
TEST(PhotonStability, AtSilhouettes) {
    SceneMaker maker(32, 4);
    maker.look({0, 0, -4}, {0, 0, 0}, 32);
    maker.environment(1);
    maker.sphere({0, 0, 0}, 1, maker.material(diffuse(0.5)));
    Scene traced = maker.scene;
    traced.settings.samples_per_pixel = 32;
    const std::vector<Image> expected = render_seeds(traced, seeds);
    RenderOptions options = with_radius(4, false);
    options.photons = 100'000;
    options.direct_photons = true;
    const Image mean = mean_image(expected);
    const auto at_silhouette = [&](const std::vector<Image> &images) {
        std::vector<double> means;
        for (const Image &image : images) {
            double sum = 0;
            int count = 0;
            for (std::uint32_t y = 0; y < image.height; ++y)
                for (std::uint32_t x = 0; x < image.width; ++x)
                    if (pixel(mean, x, y) > 0.52 && pixel(mean, x, y) < 0.98) {
                        sum += pixel(image, x, y);
                        ++count;
                    }
            EXPECT_GT(count, 40);
            means.push_back(sum / count);
        }
        return spread_of(means);
    };
    record_stability(
        {area, "silhouettes: the disc reaches beyond the surface, and where the pixel's other part is",
         "a ball before the sky, direct light by photons too, the pixels of its silhouette",
         "gathers by distance in space and by the surface's side", bias_at_most,
         largest_bias(at_silhouette(render_seeds(maker.scene, seeds, options, 1, "sppm")), at_silhouette(expected)),
         0.03});
}

class FullPhotonStabilityUnder : public ::testing::TestWithParam<const char *> {};

TEST_P(FullPhotonStabilityUnder, Glass) {
    SceneMaker maker(24, 4);
    add_floor_under_glass(maker, GetParam());
    const Scene &scene = maker.scene;
    Scene traced = scene;
    traced.settings.samples_per_pixel = 1024;
    RenderOptions options = with_radius(0.5, false); // the edges of the block: 2 % at four times as much
    options.photons = 200'000;
    const std::string piece = GetParam();
    record_stability({area,
                      piece == "a block" ? "total internal reflection in chains of photons and of camera paths"
                                         : "facets of a coarse lens: normals that jump, and that are not the surface's",
                      piece == "a block" ? "a floor seen through a block of glass on it"
                      : piece == "a smooth lens"
                          ? "a floor under a ball of 90 triangles of glass, with a ball's normals"
                          : "a floor under a ball of 90 triangles of glass",
                      "light paths bear what shading normals and refraction change; as bright as path tracing has it",
                      bias_at_most, largest_bias(means_of(scene, options), means_of(traced, {}, "pt")), 0.05});
}

INSTANTIATE_TEST_SUITE_P(Full, FullPhotonStabilityUnder,
                         ::testing::Values("a block", "a coarse lens", "a smooth lens"));

// A ground that reaches far beyond what is seen: what is seen has the radii that it has without, and each gather point
// looks at the photons near it, not at all of them.
TEST(PhotonStability, AboveALargeGround) {
    RenderOptions options;
    options.radius_alpha = 0.3;
    double radius[2], seconds[2];
    for (const bool on_ground : {false, true}) {
        SceneMaker maker(192, 8);
        const std::uint32_t gray = maker.material(diffuse(0.5));
        maker.floor(-2, 2, 4, gray);
        maker.lamp({0, 3, 0}, 1, 1, 5, maker.material(diffuse(0)));
        maker.look({0, 2, 2}, {0, 0, 0}, 40);
        if (on_ground)
            maker.parallelogram({-20000, -0.5f, -20000}, {0, 0, 40000}, {40000, 0, 0}, gray);
        const Rendered rendered = render(maker.scene, options, "sppm");
        const GatherRadii &first = rendered.statistics.first_radii, &last = rendered.statistics.last_radii;
        radius[on_ground] = last.sum / double(last.points);
        EXPECT_NEAR(radius[on_ground] / (first.sum / double(first.points)),
                    std::sqrt(radius_shrinkage(7, options.radius_alpha)), 1e-3);
        seconds[on_ground] = 0;
        for (const StageTime &stage : rendered.statistics.stages)
            seconds[on_ground] += stage.name.starts_with("photon_pairs") ? stage.seconds : 0;
    }
    record_stability({area, "a ground far larger than what is seen: radii and cells go by the whole scene",
                      "a floor 4 wide under a lamp, over a ground 40,000 wide",
                      "radii are at least what a point's own position is exact to; cells go by the radii seen",
                      "change of the mean radius of the eighth pass", std::fabs(radius[1] / radius[0] - 1), 1e-3});
    fmt::print("search: {:.4f} s without the ground, {:.4f} s with it\n", seconds[0], seconds[1]);
    EXPECT_LT(seconds[1], 20 * seconds[0]); // hundreds of times with cells that go by the scene
}

// The same random numbers in a scene of another size: rounding decides some paths otherwise, and nothing else may.
TEST(PhotonStability, InScenesOfAnotherSize) {
    Scene scene = own_scene("cornell-box.xml", 32, 32);
    scene.settings.samples_per_pixel = 2;
    RenderOptions options;
    options.photons = 50'000;
    const Image there = render(scene, options, "sppm").image;
    const double mean = spread_of(there).mean;
    for (const double factor : {1e-3, 1e4}) {
        Scene elsewhere = scene;
        place(elsewhere, factor, {0, 0, 0});
        const BlockTest blocks = block_z_test({render(elsewhere, options, "sppm").image}, there, there, 1, 1, 8);
        double largest = 0;
        for (const double difference : blocks.difference)
            largest = worse(largest, std::fabs(difference) / mean);
        record_stability({area, "scenes of another size: areas of discs and cells of the grid out of range",
                          fmt::format("scenes/cornell-box.xml times {}", factor),
                          "radius and grid go by the scene's size, positions by what they are exact to",
                          "largest change of a block of 8 x 8 pixels, relative to the image's mean", largest, 0.03});
    }
}

} // namespace
} // namespace gradus::testing
