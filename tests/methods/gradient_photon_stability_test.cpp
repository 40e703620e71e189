// Gradient-domain photon mapping where shifts of photons are at their worst: for each case a small scene, in which the
// differences must have the means that those of the primal image have.
//
// Of the residuals, differences less those of the same image's primal, two things are looked at: their squared bias, as
// for gpt (gradient_bias.h), which finds what is wrong in single pixels; and their mean product with the differences of
// independent primal images, over the mean square of those: the share of the differences that is lost or added. That
// sums over the image, so it finds what is wrong in proportion with far fewer samples. It misses errors that have
// nothing in common with the differences, which the first finds. Limits are about six of the standard errors that so
// many samples give: noise passes, four of them and what a defect adds do not.
#include "tests/methods/gradient_bias.h"
#include "tests/methods/photon_case.h"
#include "tests/methods/photon_scenes.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/placed_scene.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

#include <numeric>

namespace gradus::testing {
namespace {

constexpr const char *area = "Gradients of photons";
constexpr const char *share_at_most = "share of the differences that is lost or added at most";
constexpr std::size_t seeds = 12;

/// Direct light by photons, so that all light is theirs, and a reconstruction that costs little: nobody looks at it.
RenderOptions photon_options(double radius, std::uint64_t photons) {
    RenderOptions options = with_radius(radius, false);
    options.photons = photons;
    options.direct_photons = true;
    options.reconstruction = Reconstruction::l2;
    options.alpha = 0.2;
    return options;
}

/// A scene of 32 x 32 pixels in which things lie under the floor that make all scenes use the same kernels.
SceneMaker scene_of(std::uint64_t passes) {
    SceneMaker maker(32, passes);
    maker.scene.settings.max_depth = 5;
    maker.scene.meshes.push_back(coarse_ball({0, -0.5f, 0}, 0.01, true));
    maker.shape(Shape::Kind::mesh, 0, maker.material(glass(1.5)), -1);
    maker.sphere({0.1f, -0.5f, 0}, 0.01f, maker.material(rough_metal(0.2)));
    maker.sphere({-0.1f, -0.5f, 0}, 0.01f, maker.material(two_sided(diffuse(0.2))));
    return maker;
}

/// Both kinds of differences of a layer, all channels.
std::vector<double> changes(const Image &right, const Image &down) {
    std::vector<double> values = values_of(right);
    const std::vector<double> more = values_of(down);
    values.insert(values.end(), more.begin(), more.end());
    return values;
}

struct DifferenceBias {
    BiasEstimate squared; ///< of the residuals
    Spread share;         ///< of the differences that the residuals are
    double shifted = 0;   ///< photons, of the last seed
    double largest_share() const { return std::fabs(share.mean) + 4 * share.standard_error; }
};

double shifted_photons(const Statistics &statistics) {
    return double(statistics.shifts.at("walked") + statistics.shifts.at("reconnected"));
}

DifferenceBias difference_bias(const Scene &scene, RenderOptions options) {
    DifferenceBias bias;
    std::vector<std::vector<double>> found, truths;
    for (std::size_t seed = 1; seed <= seeds; ++seed) {
        options.seed = seed;
        const Rendered rendered = render(scene, options, "gpm");
        const Image &image = rendered.image;
        const auto given = [&](const char *name) {
            return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
                const bool at_border = std::string(name) == "dx" ? x + 1 == image.width : y + 1 == image.height;
                return at_border ? 0.0 : layer(image, name, c, x, y);
            });
        };
        found.push_back(changes(given("dx"), given("dy")));
        truths.push_back(changes(differences(image, "primal", true), differences(image, "primal", false)));
        bias.shifted = shifted_photons(rendered.statistics);
    }
    bias.squared = estimate_bias(found, truths);
    // The truth that a seed's residual is held against is that of all other seeds.
    std::vector<double> sum(truths[0].size(), 0.0), shares;
    for (const std::vector<double> &truth : truths)
        std::transform(truth.begin(), truth.end(), sum.begin(), sum.begin(), std::plus<>());
    for (std::size_t seed = 0; seed < seeds; ++seed) {
        double product = 0;
        for (std::size_t i = 0; i < sum.size(); ++i)
            product += (found[seed][i] - truths[seed][i]) * (sum[i] - truths[seed][i]);
        shares.push_back(product / double(seeds - 1) / bias.squared.magnitude);
    }
    bias.share = spread_of(shares);
    fmt::print("share {:.4f} +- {:.4f}; squared bias {:.1f} standard errors, relative bias at most {:.2g}; {:.0f} "
               "photons shifted\n",
               bias.share.mean, bias.share.standard_error, bias.squared.squared / bias.squared.standard_error,
               bias.squared.at_most(), bias.shifted);
    EXPECT_TRUE(bias.squared.is_none());
    return bias;
}

void add_plain_floor(SceneMaker &maker) { maker.floor(-2, 2, 2, maker.material(diffuse(0.6))); }

/// From above, 1.6 wide where y is 0.
void look_down(SceneMaker &maker) {
    maker.look({0, 3, 0}, {0, 0, 0}, 30, {0, 0, 1});
    maker.lamp({1.1f, 0.8f, 0.2f}, 0.3f, 0.3f, 40, maker.material(diffuse(0.5)));
}

TEST(GradientPhotonStability, AtEdgesOfMaterials) {
    SceneMaker maker = scene_of(4);
    const std::uint32_t stripes[] = {maker.material(diffuse(0.1)), maker.material(diffuse(0.9))};
    for (int i = 0; i < 12; ++i)
        maker.floor(0.17f * float(i) - 1.02f, 0.17f * float(i) - 0.85f, 2, stripes[i % 2]);
    look_down(maker);
    record_stability({area, "edges of materials: photons that count at both gather points make the difference",
                      "a floor in stripes of albedo 0.1 and 0.9, discs of three pixels",
                      "each is taken by both at half its weight", share_at_most,
                      difference_bias(maker.scene, photon_options(1.5, 8000)).largest_share(), 0.05});
}

TEST(GradientPhotonStability, OnSmallBalls) {
    SceneMaker maker = scene_of(4);
    add_plain_floor(maker);
    const std::uint32_t white = maker.material(diffuse(0.8));
    for (int i = 0; i < 16; ++i)
        maker.sphere({0.4f * float(i % 4) - 0.6f, 0.13f, 0.4f * float(i / 4) - 0.6f}, 0.13f, white);
    look_down(maker);
    record_stability(
        {area,
         "curved surfaces and silhouettes: a photon's mirror image is where both gather points have it, or "
         "neither",
         "a floor of balls, the discs half as wide as they", "the shift fails for both directions alike", share_at_most,
         difference_bias(maker.scene, photon_options(1.5, 8000)).largest_share(), 0.05});
}

TEST(GradientPhotonStability, AtSilhouettesBeforeNothing) {
    SceneMaker maker = scene_of(4);
    const std::uint32_t white = maker.material(diffuse(0.8));
    for (int i = 0; i < 9; ++i)
        maker.sphere({0.5f * float(i % 3) - 0.5f, 0.1f, 0.5f * float(i / 3) - 0.5f}, 0.2f, white);
    look_down(maker);
    record_stability({area, "silhouettes: the neighbour has no gather point",
                      "balls before nothing, a disc of three pixels", "the base photon counts for itself",
                      share_at_most, difference_bias(maker.scene, photon_options(1.5, 16'000)).largest_share(), 0.06});
}

TEST(GradientPhotonStability, OfOtherNormals) {
    for (const bool smooth : {false, true}) {
        SceneMaker maker = scene_of(16);
        add_plain_floor(maker);
        maker.scene.meshes.push_back(coarse_ball({0, 0.2f, 0}, 0.55, smooth));
        maker.shape(Shape::Kind::mesh, maker.scene.meshes.size() - 1, maker.material(diffuse(0.8)), -1);
        look_down(maker);
        record_stability({area, "faceted and smooth normals: planes jump, or are not the surface's",
                          smooth ? "a ball of 90 triangles, with a ball's normals" : "a ball of 90 triangles",
                          "shifts by geometric normals, values by shading normals", share_at_most,
                          difference_bias(maker.scene, photon_options(1.5, 4000)).largest_share(), 0.06});
    }
}

TEST(GradientPhotonStability, OnGlossyMetal) {
    SceneMaker maker = scene_of(8);
    maker.floor(-2, 2, 2, maker.material(rough_metal(0.1)));
    maker.sphere({0, 0.3f, 0.3f}, 0.2f, maker.material(diffuse(0.8)));
    maker.look({0, 1.5, -1.5}, {0, 0, 0}, 30);
    maker.lamp({0, 2, 1.2f}, 0.8f, 0.8f, 10, maker.material(diffuse(0.5)));
    record_stability({area, "gathering on glossy surfaces: lobes turn from pixel to pixel",
                      "a floor of metal of roughness 0.1 that shows a lamp",
                      "evaluates the BSDF of each photon at both gather points", share_at_most,
                      difference_bias(maker.scene, photon_options(1.5, 32'000)).largest_share(), 0.15});
}

/// A wall throws a caustic onto the floor. Half of it is a mirror, the other half a dark one, so that a walk that took
/// the one for the other would be off by far.
TEST(FullGradientPhotonStability, ByABlendOfMirrors) {
    SceneMaker maker = scene_of(32);
    add_plain_floor(maker);
    Bsdf blend, dark = mirror();
    dark.specular_reflectance = {0.1f, 0.1f, 0.1f};
    maker.scene.blended = {mirror(), dark};
    maker.scene.blends = {{0, 1, 0.5f}};
    blend.blend = 0;
    maker.parallelogram({-0.6f, 0, -0.5f}, {0, 0.6f, 0}, {0, 0, 1}, maker.material(two_sided(blend)));
    look_down(maker);
    record_stability({area, "blends: a walk meets the whole, and not the part that the photon has met",
                      "a floor beside a wall that is half a mirror, half a dark one", "takes the part that was met",
                      share_at_most, difference_bias(maker.scene, photon_options(1.5, 8000)).largest_share(), 0.05});
}

TEST(GradientPhotonStability, InACorner) {
    SceneMaker maker = scene_of(16);
    maker.parallelogram({0, 0, 0}, {0, 0, 2}, {2, 0, 0}, maker.material(two_sided(diffuse(0.8))));
    maker.parallelogram({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(two_sided(diffuse(0.5))));
    maker.parallelogram({0, 0, 0}, {0, 2, 0}, {0, 0, 2}, maker.material(two_sided(diffuse(0.3))));
    maker.lamp({0.6f, 1, 0.8f}, 0.4f, 0.4f, 10, maker.material(diffuse(0.5)));
    maker.look({1, 1.1, 1.2}, {0, 0, 0}, 16);
    record_stability({area, "corners: a photon's mirror image is on another wall, or none",
                      "a corner of three walls, discs of six pixels", "the shift fails for both directions alike",
                      share_at_most, difference_bias(maker.scene, photon_options(3, 8000)).largest_share(), 0.04});
}

TEST(GradientPhotonStability, WhereFewPhotonsAreSeen) {
    for (const std::uint64_t photons : {200, 1}) {
        SceneMaker maker = scene_of(photons == 1 ? 140 : 20);
        const std::uint32_t stripes[] = {maker.material(diffuse(0.1)), maker.material(diffuse(0.9))};
        for (int i = 0; i < 6; ++i)
            maker.floor(0.34f * float(i) - 1.02f, 0.34f * float(i) - 0.68f, 2, stripes[i % 2]);
        look_down(maker);
        record_stability({area, photons == 1 ? "one light path a pass" : "few photons seen",
                          photons == 1 ? "140 passes of one light path" : "20 passes of 200 light paths",
                          "each photon is shifted by itself", share_at_most,
                          difference_bias(maker.scene, photon_options(3, photons)).largest_share(),
                          photons == 1 ? 0.3 : 0.06});
    }
}

void record_under_glass(const std::string &piece) {
    SceneMaker maker = scene_of(8);
    add_floor_under_glass(maker, piece.c_str());
    const bool is_block = piece == "a block", is_smooth = piece == "a smooth lens";
    record_stability(
        {area,
         is_block ? "total internal reflection in chains of photons: the chain beside it may leave"
                  : "facets of a coarse lens: chains of photons end at their edges",
         is_block    ? "a floor seen through a block of glass on it"
         : is_smooth ? "a floor under a ball of 90 triangles of glass, with a ball's normals"
                     : "a floor under a ball of 90 triangles of glass",
         "a walk that fails, or whose way back does not come back, is no shift; the base photon counts for itself",
         share_at_most, difference_bias(maker.scene, photon_options(1.5, 16'000)).largest_share(), 0.2});
}

TEST(GradientPhotonStability, UnderGlass) { record_under_glass("a smooth lens"); }

TEST(FullGradientPhotonStability, UnderGlass) {
    for (const char *piece : {"a block", "a coarse lens"})
        record_under_glass(piece);
}

// The same random numbers: rounding decides some paths otherwise, and nothing else may.
TEST(GradientPhotonStability, InScenesOfAnotherSize) {
    SceneMaker maker = scene_of(4);
    add_plain_floor(maker);
    const std::uint32_t white = maker.material(diffuse(0.8));
    for (int i = 0; i < 9; ++i)
        maker.sphere({0.5f * float(i % 3) - 0.5f, 0.1f, 0.5f * float(i / 3) - 0.5f}, 0.2f, white);
    look_down(maker);
    RenderOptions options = photon_options(1.5, 12'000);
    options.seed = seeds;
    const double shifted = shifted_photons(render(maker.scene, options, "gpm").statistics);
    for (const double factor : {1e-3, 1e4}) {
        Scene elsewhere = maker.scene;
        place(elsewhere, factor, {0, 0, 0});
        const DifferenceBias bias = difference_bias(elsewhere, options);
        EXPECT_NEAR(bias.shifted, shifted, 1e-3 * shifted) << "times " << factor;
        record_stability({area, "scenes of another size: planes and mirrors by products out of range",
                          fmt::format("balls on a floor, 2 wide, times {}", factor),
                          "goes by ratios and unit vectors; shifts as many photons", share_at_most,
                          bias.largest_share(), 0.04});
    }
}

TEST(GradientPhotonStability, AtTheLimitsOfTheRadius) {
    std::size_t wrong = 0;
    for (const double value : {1e-30, 1e-9, 1e3, 1e18, 1e30})
        for (const bool of_scene : {false, true}) {
            SceneMaker maker = scene_of(1);
            maker.scene.film.width = maker.scene.film.height = 8;
            add_plain_floor(maker);
            look_down(maker);
            RenderOptions options = photon_options(1, 300);
            options.radius = RenderOptions::GatherRadius{value, of_scene};
            for (const Channel &channel : render(maker.scene, options, "gpm").image.channels)
                for (const float number : channel.values)
                    wrong += std::fabs(number) < 1e9 ? 0 : 1;
        }
    record_stability({area, "a radius that vanishes or overflows when it is squared",
                      "a floor under a lamp, radii from 1e-30 to 1e30 pixels or diameters",
                      "at least what positions are exact to; in pixels a twentieth of the scene at most",
                      "values of primal and differences that are not finite or above 1e9", double(wrong), 0});
}

TEST(GradientPhotonStability, AtThinWalls) {
    float brightest = 0;
    const double diameter = 1.01 * std::sqrt(3.0) * 2;
    for (const auto &[between, radius] : {std::pair{0.0, 0.01}, {0.001, 0.01}, {0.005, 0.17}}) {
        RenderOptions options = photon_options(1, 10'000);
        options.radius = RenderOptions::GatherRadius{radius / diameter, true};
        const Rendered outside = render(thin_walls(between, true), options, "gpm");
        EXPECT_GT(outside.statistics.gather_points, 100u);
        for (const Channel &channel : outside.image.channels)
            for (const float value : channel.values)
                brightest = std::max(brightest, std::fabs(value));
    }
    record_stability({area, "thin walls: a photon is shifted through them",
                      "a lit box with walls of 0, 1 and 5 mm, radius 10, 10 and 170 mm",
                      "photons count where their surface faces the same way",
                      "largest value outside, differences included", brightest, 0});
}

} // namespace
} // namespace gradus::testing
