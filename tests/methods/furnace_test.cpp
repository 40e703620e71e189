// Furnaces: an object in a constant environment of radiance 1, and a closed room that emits.
#include "runtime/scene/traits.h"
#include "tests/methods/furnace_walk.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

const char *const channels[] = {"R", "G", "B"};

// The object fills the image: seen from 3 away the sphere has a half angle of 19.5 degrees, and the corners of this
// image have 19.4, so that the incidence goes up to 87 degrees. The cube holds the unit sphere.
const View sphere_view{{0, 0, -3}, 28};
const View cube_view{{3, 2.5, -4}, 14};

const View &view_of(ConvexShape shape) { return shape == ConvexShape::sphere ? sphere_view : cube_view; }

SceneMaker furnace(ConvexShape shape, const Material &material, std::uint32_t size, std::uint64_t samples,
                   bool flip_normals = false) {
    SceneMaker maker(size, samples);
    const View &view = view_of(shape);
    maker.look({view.from[0], view.from[1], view.from[2]}, {0, 0, 0}, view.fov);
    const std::uint32_t index = maker.material(material);
    if (shape == ConvexShape::sphere)
        maker.sphere({0, 0, 0}, 1, index, -1, flip_normals);
    else
        maker.cube(index, -1, flip_normals);
    maker.environment(1);
    return maker;
}

RenderOptions with(RenderOptions::Strategy strategy) {
    RenderOptions options;
    options.strategy = strategy;
    options.seed = 5;
    return options;
}

Bsdf rough(BsdfKind kind, double alpha_u, double alpha_v) {
    Bsdf bsdf;
    bsdf.kind = kind;
    bsdf.alpha_u = float(alpha_u);
    bsdf.alpha_v = float(alpha_v);
    return bsdf;
}

constexpr ConvexShape both_shapes[] = {ConvexShape::sphere, ConvexShape::cube};

const char *name_of(ConvexShape shape) { return shape == ConvexShape::sphere ? "sphere" : "cube"; }

// With BSDF sampling alone each single path of these carries what it must: nothing is left to chance. A smooth
// dielectric scales radiance by the squared index on the way in and back on the way out.
TEST(Furnace, MaterialsThatLoseNothingVanish) {
    Bsdf nothing;
    nothing.kind = BsdfKind::null;
    const struct {
        const char *name;
        Material material;
    } cases[] = {{"white diffuse", material_of(diffuse(1))},
                 {"white diffuse on both sides", two_sided(diffuse(1))},
                 {"mirror", material_of(mirror())},
                 {"mirror on both sides", two_sided(mirror())},
                 {"glass", material_of(glass(1.5046))},
                 {"air in water", material_of(glass(0.75))},
                 {"null", material_of(nothing)}};
    double worst = 0;
    for (const auto &c : cases)
        for (const ConvexShape shape : both_shapes) {
            SCOPED_TRACE(fmt::format("{} {}", c.name, name_of(shape)));
            const Scene scene = furnace(shape, c.material, 64, 16).scene;
            const Image image = render(scene, with(RenderOptions::Strategy::bsdf)).image;
            for (const char *channel : channels) {
                const Spread spread = spread_of(image, channel);
                EXPECT_NEAR(spread.least, 1, 2e-5) << channel;
                EXPECT_NEAR(spread.most, 1, 2e-5) << channel;
                worst = std::max({worst, 1 - spread.least, spread.most - 1});
            }
        }
    record_stability(
        {"Path tracing", "energy lost or made at surfaces, most of all at grazing incidence and inside glass",
         "white furnaces: a sphere and a cube of each material that loses nothing, incidence up to 87 degrees",
         "each path carries 1", "largest error of a pixel", worst, 2e-5});
}

TEST(Furnace, LightSamplingAddsNothingAndLosesNothing) {
    for (const ConvexShape shape : both_shapes)
        for (const auto strategy : {RenderOptions::Strategy::mis, RenderOptions::Strategy::light}) {
            SCOPED_TRACE(fmt::format("{} strategy {}", name_of(shape), int(strategy)));
            const Image image = render(furnace(shape, material_of(diffuse(1)), 64, 256).scene, with(strategy)).image;
            const Spread spread = spread_of(image);
            EXPECT_GT(spread.standard_error, 0);
            EXPECT_LT(spread.standard_error, 2e-3);
            EXPECT_NEAR(spread.mean, 1, 4 * spread.standard_error);
        }
}

TEST(Furnace, AConvexDiffuseObjectShowsItsAlbedo) {
    Bsdf paint = diffuse(0);
    paint.reflectance = {0.2f, 0.5f, 0.8f};
    for (const ConvexShape shape : both_shapes) {
        SCOPED_TRACE(name_of(shape));
        const Image exact =
            render(furnace(shape, material_of(paint), 32, 4).scene, with(RenderOptions::Strategy::bsdf)).image;
        const Image noisy =
            render(furnace(shape, material_of(paint), 32, 64).scene, with(RenderOptions::Strategy::mis)).image;
        const double albedo[] = {0.2, 0.5, 0.8};
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(spread_of(exact, channels[c]).least, albedo[c], 1e-6);
            EXPECT_NEAR(spread_of(exact, channels[c]).most, albedo[c], 1e-6);
            const Spread spread = spread_of(noisy, channels[c]);
            EXPECT_NEAR(spread.mean, albedo[c], 4 * spread.standard_error) << channels[c];
        }
    }
}

TEST(Furnace, TheBackOfAOneSidedMaterialIsBlack) {
    const Bsdf kinds[] = {diffuse(1), mirror(), rough_metal(0.3), rough(BsdfKind::roughconductor_beckmann, 0.3, 0.3)};
    for (const Bsdf &bsdf : kinds)
        for (const ConvexShape shape : both_shapes) {
            SCOPED_TRACE(fmt::format("{} {}", bsdf_kind_name(bsdf), name_of(shape)));
            const Image image = render(furnace(shape, material_of(bsdf), 16, 16, true).scene).image;
            EXPECT_EQ(spread_of(image).most, 0);
        }
}

TEST(Furnace, TwoSidedMaterialsShowTheSideThatIsSeen) {
    const Material two_paints = two_sided(diffuse(0.25), diffuse(0.75));
    const Material two_kinds = two_sided(mirror(), diffuse(0.5));
    for (const ConvexShape shape : both_shapes) {
        SCOPED_TRACE(name_of(shape));
        const auto shown = [&](const Material &material, bool flip) {
            const Spread spread = spread_of(
                render(furnace(shape, material, 16, 16, flip).scene, with(RenderOptions::Strategy::bsdf)).image);
            EXPECT_NEAR(spread.most, spread.least, 1e-5);
            return spread.mean;
        };
        EXPECT_NEAR(shown(two_paints, false), 0.25, 1e-5);
        EXPECT_NEAR(shown(two_paints, true), 0.75, 1e-5);
        EXPECT_NEAR(shown(two_kinds, false), 1, 1e-5);
        EXPECT_NEAR(shown(two_kinds, true), 0.5, 1e-5);
    }
}

struct WalkCase {
    std::string name;
    Bsdf bsdf;
};

void PrintTo(const WalkCase &c, std::ostream *out) { *out << c.name; }

class FurnaceWalk : public ::testing::TestWithParam<WalkCase> {};

/// Mean of a channel and its standard error, from the variance of each pixel.
Spread estimate(const Image &image, const std::string &channel) {
    Spread spread = spread_of(image, channel);
    double variance = 0;
    for (const float value : image.find("variance." + channel)->values)
        variance += value;
    spread.standard_error = std::sqrt(variance) / (double(image.width) * image.height);
    return spread;
}

// Microfacets without multiple scattering lose what would be scattered again, so 1 is an upper bound for those that
// do not absorb; how much is lost is what the walks on the host say.
TEST_P(FurnaceWalk, IsReproduced) {
    const Bsdf &bsdf = GetParam().bsdf;
    RenderOptions options = with(RenderOptions::Strategy::mis);
    options.aov = true;
    for (const ConvexShape shape : both_shapes) {
        const Image image = render(furnace(shape, material_of(bsdf), 32, 64).scene, options).image;
        const WalkMean expected = walk(shape, bsdf, view_of(shape), 50'000);
        for (int c = 0; c < 3; ++c) {
            SCOPED_TRACE(fmt::format("{} {} {}", GetParam().name, name_of(shape), channels[c]));
            const Spread spread = estimate(image, channels[c]);
            const double error = std::hypot(spread.standard_error, expected.standard_error[c]);
            EXPECT_LT(error, 3e-3) << "too noisy to tell";
            // The renderer computes in float; smooth kinds have no noise at all.
            EXPECT_NEAR(spread.mean, expected.mean[c], 4 * error + 1e-5);
            EXPECT_LT(spread.mean, 1 + 4 * spread.standard_error + 1e-5);
            if (c == 0)
                fmt::print("{:<36} {:<6} {:.4f}, walks {:.4f}, error {:.4f}\n", GetParam().name, name_of(shape),
                           spread.mean, expected.mean[c], error);
        }
    }
}

std::vector<WalkCase> walks_of_roughness(const std::vector<std::pair<double, double>> &roughness) {
    std::vector<WalkCase> cases;
    for (const BsdfKind kind : {BsdfKind::roughconductor_ggx, BsdfKind::roughconductor_beckmann,
                                BsdfKind::roughdielectric_ggx, BsdfKind::roughdielectric_beckmann})
        for (const auto &[alpha_u, alpha_v] : roughness) {
            const Bsdf bsdf = rough(kind, alpha_u, alpha_v);
            cases.push_back(
                {fmt::format("{}_{:.0f}_{:.0f}", bsdf_kind_name(bsdf), 100 * alpha_u, 100 * alpha_v), bsdf});
        }
    return cases;
}

std::vector<WalkCase> walk_cases() {
    std::vector<WalkCase> cases = walks_of_roughness({{0.2, 0.2}, {0.1, 0.5}});
    Bsdf copper = mirror();
    copper.eta = {0.271f, 0.677f, 1.317f};
    copper.k = {3.61f, 2.625f, 2.292f};
    copper.specular_reflectance = {0.9f, 0.8f, 0.7f};
    cases.push_back({"copper", copper});
    copper.kind = BsdfKind::roughconductor_beckmann;
    copper.alpha_u = copper.alpha_v = 0.3f;
    cases.push_back({"rough_copper", copper});
    Bsdf tinted = glass(1.33);
    tinted.specular_reflectance = {0.5f, 0.75f, 1};
    tinted.specular_transmittance = {0.9f, 0.6f, 0.3f};
    cases.push_back({"tinted_glass", tinted});
    tinted.kind = BsdfKind::roughdielectric_ggx;
    tinted.alpha_u = tinted.alpha_v = 0.3f;
    cases.push_back({"tinted_rough_glass", tinted});
    tinted.ior = 0.75f;
    cases.push_back({"tinted_rough_bubble", tinted});
    return cases;
}

INSTANTIATE_TEST_SUITE_P(Furnace, FurnaceWalk, ::testing::ValuesIn(walk_cases()),
                         [](const auto &info) { return info.param.name; });
INSTANTIATE_TEST_SUITE_P(Full, FurnaceWalk, ::testing::ValuesIn(walks_of_roughness({{0.02, 0.02}, {0.6, 0.6}})),
                         [](const auto &info) { return info.param.name; });

// Every point of a closed room of emission E and albedo a has radiance E (1 + a + a^2 + ...).
class Room : public ::testing::TestWithParam<const char *> {
  protected:
    static ConvexShape shape() { return GetParam() == std::string("cube") ? ConvexShape::cube : ConvexShape::sphere; }
};

SceneMaker room(ConvexShape shape, double emission, double albedo, std::uint64_t samples) {
    SceneMaker maker(32, samples);
    maker.look({0.2, -0.1, -0.3}, {0.3, 0.2, 1}, 90);
    const std::uint32_t material = maker.material(diffuse(albedo));
    const float e = float(emission);
    const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {e, e, e});
    if (shape == ConvexShape::cube)
        maker.cube(material, emitter, true);
    else
        maker.sphere({0, 0, 0}, 1, material, emitter, true);
    return maker;
}

TEST_P(Room, OfInfiniteDepthIsAGeometricSeries) {
    for (const double albedo : {0.5, 0.8})
        for (const auto strategy : {RenderOptions::Strategy::mis, RenderOptions::Strategy::bsdf}) {
            SCOPED_TRACE(fmt::format("albedo {} strategy {}", albedo, int(strategy)));
            SceneMaker maker = room(shape(), 0.7, albedo, 256);
            maker.scene.settings.rr_depth = 5;
            const Spread spread = spread_of(render(maker.scene, with(strategy)).image);
            const double expected = 0.7 / (1 - albedo);
            EXPECT_LT(spread.standard_error, 5e-3 * expected);
            EXPECT_NEAR(spread.mean, expected, 4 * spread.standard_error + 1e-5 * expected);
        }
}

// With BSDF sampling alone each path finds E at each of its vertices: no noise.
TEST_P(Room, OfDepthNHasNTerms) {
    for (int depth = 0; depth <= 6; ++depth) {
        SceneMaker maker = room(shape(), 0.7, 0.8, 4);
        maker.scene.settings.max_depth = depth;
        const Spread spread = spread_of(render(maker.scene, with(RenderOptions::Strategy::bsdf)).image);
        const double expected = 0.7 * (1 - std::pow(0.8, depth)) / (1 - 0.8);
        EXPECT_NEAR(spread.least, expected, 1e-5) << "depth " << depth;
        EXPECT_NEAR(spread.most, expected, 1e-5) << "depth " << depth;
        maker.scene.settings.samples_per_pixel = 64;
        const Spread noisy = spread_of(render(maker.scene, with(RenderOptions::Strategy::mis)).image);
        EXPECT_NEAR(noisy.mean, expected, 4 * noisy.standard_error + 1e-5) << "depth " << depth;
    }
}

INSTANTIATE_TEST_SUITE_P(Furnace, Room, ::testing::Values("sphere", "cube"));

} // namespace
} // namespace gradus::testing
