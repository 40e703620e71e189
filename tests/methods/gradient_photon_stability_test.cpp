// Gradient-domain photon mapping where shifts of photons are at their worst: for each case a small scene, in which the
// differences must have the means that those of the primal image have.
//
// Of the residuals, differences less those of the same image's primal, two things are looked at: their squared bias, as
// for gpt (gradient_bias.h), which finds what is wrong in single pixels; and their mean product with the differences of
// independent primal images, over the mean square of those: the share of the differences that is lost or added. That
// sums over the image, so it finds what is wrong in proportion with far fewer samples. It misses errors that have
// nothing in common with the differences, which the first finds.
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
    options.norm = PoissonNorm::l2;
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
    double largest_share() const { return std::fabs(share.mean) + 4 * share.standard_error; }
};

DifferenceBias difference_bias(const Scene &scene, RenderOptions options) {
    std::vector<std::vector<double>> found, truths;
    double moved = 0;
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
        for (const auto &[what, count] : rendered.statistics.shifts)
            moved += what == "failed" ? 0 : double(count);
    }
    DifferenceBias bias{estimate_bias(found, truths), {}};
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
               bias.squared.at_most(), moved);
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
    SceneMaker maker = scene_of(16);
    const std::uint32_t stripes[] = {maker.material(diffuse(0.1)), maker.material(diffuse(0.9))};
    for (int i = 0; i < 12; ++i)
        maker.floor(0.17f * float(i) - 1.02f, 0.17f * float(i) - 0.85f, 2, stripes[i % 2]);
    look_down(maker);
    record_stability({area, "edges of materials: photons that count at both gather points make the difference",
                      "a floor in stripes of albedo 0.1 and 0.9, discs of three pixels",
                      "each is taken by both at half its weight", share_at_most,
                      difference_bias(maker.scene, photon_options(1.5, 4000)).largest_share(), 0.05});
}

TEST(GradientPhotonStability, OnSmallBalls) {
    SceneMaker maker = scene_of(16);
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
         difference_bias(maker.scene, photon_options(1.5, 4000)).largest_share(), 0.05});
}

} // namespace
} // namespace gradus::testing
