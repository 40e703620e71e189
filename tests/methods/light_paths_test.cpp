// Light paths: what lights send out, what arrives and what goes on, against closed forms and the path tracer.
#include "tests/methods/light_paths_case.h"
#include "tests/support/chi_square.h"
#include "tests/support/quadrature.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace gradus::testing {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::uint32_t many = 400'000;

/// Means lie within 4.5 standard errors: a chance of 7e-6 each, and less than 1e-3 for all of this file. Where nothing
/// is left to chance, the rounding of a float's sums and products.
void expect_flux(const Spread &flux, double expected, const std::string &what) {
    EXPECT_NEAR(flux.mean, expected, 4.5 * flux.standard_error + 2e-6 * expected) << what;
}

// A closed room with walls of albedo a that one lamp lights: photons of depth d bear a^(d - 1) of its power.
TEST(LightPathsOf, AFurnaceFollowTheGeometricSeries) {
    for (const int rr_depth : {-1, 5}) {
        SceneMaker maker(4, 1);
        const double albedo = 0.6, radiance = 2;
        maker.cube(maker.material(diffuse(albedo)), -1, true);
        // A one-sided lamp absorbs what its back gets, so it lies close to the ceiling.
        maker.lamp({0, 0.99999f, 0}, 0.5f, 0.25f, float(radiance), maker.material(diffuse(albedo)));
        maker.scene.settings.rr_depth = rr_depth;
        maker.scene.settings.max_depth = 9;
        LightPathsCase light(maker.scene);
        constexpr std::uint32_t count = many / 2;
        const std::vector<Photon> photons = light.trace(0, count);
        const double power = pi * radiance * 0.125;
        for (std::uint32_t depth = 1; depth <= 8; ++depth)
            expect_flux(flux(photons, count, [&](const Photon &p) { return p.depth == depth; }),
                        power * std::pow(albedo, depth - 1), fmt::format("depth {} roulette {}", depth, rr_depth));
    }
}

/// The floor [-1, 1] x [-1, 1] at y = 0, black, so that paths end there, and nothing else yet.
SceneMaker black_floor() {
    SceneMaker maker(4, 1);
    maker.floor(-1, 1, 1, maker.material(diffuse(0)));
    return maker;
}

/// The flux on the floor, and how it is spread over 8 x 8 squares of it, for an irradiance (x, z) in closed form.
void expect_irradiance(const Scene &scene, const std::function<double(double, double)> &irradiance, double total_power,
                       const std::string &what) {
    constexpr int side = 8;
    LightPathsCase light(scene);
    const std::vector<Photon> photons = light.trace(0, many);
    std::vector<double> counts(side * side + 1, 0.0), expected(side * side + 1, 0.0);
    double flux_expected = 0;
    for (int x = 0; x < side; ++x)
        for (int z = 0; z < side; ++z) {
            const double part = integrate(irradiance, -1 + 2.0 * x / side, -1 + 2.0 * (x + 1) / side,
                                          -1 + 2.0 * z / side, -1 + 2.0 * (z + 1) / side, 2);
            expected[x * side + z] = part / total_power * many;
            flux_expected += part;
        }
    for (const Photon &photon : photons) {
        EXPECT_EQ(photon.depth, 1u);
        EXPECT_NEAR(photon.power[1], total_power, 1e-5 * total_power); // of one light, all are alike
        EXPECT_NEAR(photon.position[1], 0, 1e-6);
        EXPECT_NEAR(photon.normal[1], 1, 1e-6);
        const auto place = [](double at) { return std::min(side - 1, int((at + 1) / 2 * side)); };
        ++counts[place(photon.position[0]) * side + place(photon.position[2])];
    }
    // The last cell: what misses the floor.
    counts.back() = many - double(photons.size());
    expected.back() = many * (1 - flux_expected / total_power);
    const ChiSquare test = chi_square(counts, expected);
    EXPECT_GT(test.p_value, 1e-5) << what;
    expect_flux(flux(photons, many, [](const Photon &) { return 1.0; }), flux_expected, what);
}

TEST(LightPathsOf, APointFollowItsIntensity) {
    SceneMaker maker = black_floor();
    const double height = 0.7, x0 = 0.2;
    maker.point_light({1, 3, 2}, {float(x0), float(height), 0});
    expect_irradiance(
        maker.scene,
        [&](double x, double z) {
            const double squared = (x - x0) * (x - x0) + z * z + height * height;
            return 3 * height / std::pow(squared, 1.5);
        },
        4 * pi * 3, "point");
}

TEST(LightPathsOf, ADirectionCrossTheWholeScene) {
    SceneMaker maker = black_floor();
    const double length = std::sqrt(0.25 + 1 + 0.36);
    maker.directional_light({1, 4, 2}, {float(0.5 / length), float(-1 / length), float(-0.6 / length)});
    // The scene's sphere: half of the floor's diagonal, a hundredth wider.
    expect_irradiance(
        maker.scene, [&](double, double) { return 4 / length; }, 4 * pi * 2 * 1.01 * 1.01, "directional");
}

TEST(LightPathsOf, AnEnvironmentComeFromAllSides) {
    SceneMaker maker = black_floor();
    maker.environment(1.5);
    expect_irradiance(
        maker.scene, [&](double, double) { return 1.5 * pi; }, 1.5 * 4 * pi * pi * 2 * 1.01 * 1.01, "environment");
}

// Its radiance is 2 straight above, falls evenly with the angle, and is nothing straight below.
TEST(LightPathsOf, AnEnvironmentMapComeByItsRadiance) {
    SceneMaker maker = black_floor();
    maker.environment_map(6, 5, [](std::uint32_t, std::uint32_t row) { return 2 - 0.5 * row; });
    LightPathsCase light(maker.scene);
    // Per area 2 pi times the integral of (2 - 2 t / pi) cos t sin t up to pi / 2, where that of t cos t sin t is pi
    // / 8.
    expect_flux(flux(light.trace(0, many), many, [](const Photon &) { return 1.0; }), 4 * 1.5 * pi, "map");
}

TEST(LightPathsOf, ASpotFillItsCone) {
    SceneMaker maker = black_floor();
    maker.spot({1, 3, 2}, {0.1f, 1.2f, 0}, {0, -1, 0}, 60, 60); // wider than the floor, and without a rim
    expect_irradiance(
        maker.scene,
        [&](double x, double z) {
            const double squared = (x - 0.1) * (x - 0.1) + z * z + 1.2 * 1.2;
            return 3 * 1.2 / std::pow(squared, 1.5);
        },
        2 * pi * (1 - 0.5) * 3, "spot");
}

TEST(LightPathsOf, ASpotFadeTowardsItsRim) {
    SceneMaker maker = black_floor();
    maker.spot({3, 3, 3}, {0, 1, 0}, {0, -1, 0}, 10, 40);
    const double c = 40 * pi / 180, b = 10 * pi / 180;
    LightPathsCase light(maker.scene);
    expect_flux(flux(light.trace(0, many), many, [](const Photon &) { return 1.0; }),
                2 * pi * 3 * (1 - (std::sin(c) - std::sin(b)) / (c - b)), "spot with a rim");
}

// Outside, a sphere that emits evenly is a point of the intensity L pi r^2, where it is above the horizon.
TEST(LightPathsOf, ASphereFollowThoseOfAPoint) {
    SceneMaker maker = black_floor();
    const double height = 0.8, radius = 0.3, x0 = -0.3;
    const std::uint32_t black = maker.material(diffuse(0));
    maker.sphere({float(x0), float(height), 0}, float(radius), black, maker.emitter(Emitter::Kind::area, {2, 2, 2}));
    expect_irradiance(
        maker.scene,
        [&](double x, double z) {
            const double squared = (x - x0) * (x - x0) + z * z + height * height;
            return 2 * pi * radius * radius * height / std::pow(squared, 1.5);
        },
        2 * pi * 4 * pi * radius * radius, "sphere");
}

TEST(LightPathsOf, ALampFollowItsFormFactors) {
    SceneMaker maker = black_floor();
    maker.lamp({0.1f, 0.5f, 0.2f}, 0.8f, 1.2f, 3, maker.material(diffuse(0)));
    const double h = 0.5;
    expect_irradiance(
        maker.scene,
        [&](double x, double z) {
            return 3 * integrate(
                           [&](double u, double v) {
                               const double squared = (u - x) * (u - x) + (v - z) * (v - z) + h * h;
                               return h * h / (squared * squared);
                           },
                           0.1 - 0.4, 0.1 + 0.4, 0.2 - 0.6, 0.2 + 0.6, 4);
        },
        3 * pi * 0.8 * 1.2, "lamp");
}

// Facing unit squares at distance 1: the form factor is 0.1998 (Howell, catalog of configuration factors, C-11).
TEST(LightPathsOf, FacingSquaresExchangeTheirFormFactor) {
    SceneMaker maker(4, 1);
    maker.floor(-0.5, 0.5, 0.5, maker.material(diffuse(0)));
    maker.lamp({0, 1, 0}, 1, 1, 1, maker.material(diffuse(0)));
    LightPathsCase light(maker.scene);
    const Spread spread = flux(light.trace(0, many), many, [](const Photon &) { return 1.0; });
    EXPECT_NEAR(spread.mean, 0.199825 * pi, 4.5 * spread.standard_error);
}

/// A ball of few triangles whose interpolated normals are far from its faces'.
Mesh coarse_ball(Vector3 center, float radius) {
    Mesh mesh;
    const auto add = [&](float x, float y, float z) {
        const float scale = 1 / std::sqrt(x * x + y * y + z * z);
        mesh.normals.push_back({x * scale, y * scale, z * scale});
        mesh.positions.push_back(
            {center.x + radius * x * scale, center.y + radius * y * scale, center.z + radius * z * scale});
    };
    for (const float sign : {-1.0f, 1.0f})
        for (int axis = 0; axis < 3; ++axis)
            add(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
    for (int x = 0; x < 2; ++x)
        for (int y = 0; y < 2; ++y)
            for (int z = 0; z < 2; ++z) {
                const std::uint32_t a = x ? 3 : 0, b = y ? 4 : 1, c = z ? 5 : 2;
                if ((x + y + z) % 2 == 1)
                    mesh.triangles.push_back({a, b, c});
                else
                    mesh.triangles.push_back({a, c, b});
            }
    return mesh;
}

struct Agreement {
    const char *name;
    std::function<void(SceneMaker &)> furnish;
};

void PrintTo(const Agreement &c, std::ostream *out) { *out << c.name; }

void add_ball(SceneMaker &maker, const Bsdf &bsdf, bool smooth_mesh) {
    const Vector3 center{0.1f, 1.4f, 0};
    const std::uint32_t material = maker.material(bsdf);
    if (!smooth_mesh) {
        maker.sphere(center, 0.6f, material);
        return;
    }
    maker.scene.meshes.push_back(coarse_ball(center, 0.6f));
    maker.shape(Shape::Kind::mesh, maker.scene.meshes.size() - 1, material, -1);
}

void add_lamp(SceneMaker &maker) { maker.lamp({0, 2.5f, 0}, 2, 2, 1, maker.material(diffuse(0))); }

void add_upward_lamp(SceneMaker &maker) {
    maker.parallelogram({-0.9f, 0.6f, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}, maker.material(diffuse(0)),
                        maker.emitter(Emitter::Kind::area, {1, 1, 1}));
}

/// A card above the floor at that height, glass with its front up and all else with its front down, with shading
/// normals 27 degrees off its own.
void add_card(SceneMaker &maker, float height, const Bsdf &bsdf) {
    const bool is_up = bsdf.kind == BsdfKind::dielectric;
    const Vector3 along_x{2.4f, 0, 0}, along_z{0, 0, 2.4f};
    maker.parallelogram({-1.2f, height, -1.2f}, is_up ? along_z : along_x, is_up ? along_x : along_z,
                        maker.material(bsdf));
    const Vector3 normal = to_float(normalize({0.5, is_up ? 1.0 : -1.0, 0}));
    maker.scene.meshes.back().normals.assign(4, normal);
}

Bsdf paint() { return diffuse(0.8); }

// What stands alone in the cases of full_agreements turns up beside others in these.
const Agreement agreements[] = {
    {"diffuse_turned", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, paint(), true); }},
    {"glass_turned", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, glass(1.5), true); }},
    {"rough_glass_turned", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, rough_glass(0.4, 1.5), true); }},
    // The detector lies in glass: what crosses its boundary once keeps its power, while radiance grows by 2.25.
    {"in_glass",
     [](SceneMaker &maker) {
         add_lamp(maker);
         maker.parallelogram({-1.5f, 1, -1.5f}, {0, 0, 3}, {3, 0, 0}, maker.material(glass(1.5)));
     }},
    // A lamp that shines upwards, and a card above it whose normals all lean to one side: nothing averages out.
    {"metal_card_turned", [](SceneMaker &maker) { add_upward_lamp(maker), add_card(maker, 1.6f, rough_metal(0.4)); }},
    {"lights",
     [](SceneMaker &maker) {
         add_lamp(maker), add_ball(maker, paint(), false);
         maker.point_light({1, 1, 1}, {0.7f, 0.7f, 0.7f});
         maker.directional_light({0.5f, 0.5f, 0.5f}, {0, -1, 0});
         maker.sphere({-0.6f, 0.9f, -0.6f}, 0.2f, maker.material(diffuse(0.5)),
                      maker.emitter(Emitter::Kind::area, {4, 4, 4}));
         maker.environment(0.3);
     }},
};

const Agreement full_agreements[] = {
    {"diffuse", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, paint(), false); }},
    {"metal_turned", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, rough_metal(0.3), true); }},
    {"glass", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, glass(1.5), false); }},
    {"rough_glass", [](SceneMaker &maker) { add_lamp(maker), add_ball(maker, rough_glass(0.3, 1.5), false); }},
    {"card_turned", [](SceneMaker &maker) { add_upward_lamp(maker), add_card(maker, 1.6f, paint()); }},
    {"in_glass_turned", [](SceneMaker &maker) { add_lamp(maker), add_card(maker, 1, glass(1.5)); }},
};

class LightPathsAndPathTracer : public ::testing::TestWithParam<Agreement> {};

// A camera that sees a diffuse floor and nothing else, each part of it alike often: the mean of its image times pi over
// the albedo is the floor's irradiance, by the path tracer. What stands around is above the camera.
TEST_P(LightPathsAndPathTracer, Agree) {
    constexpr double albedo = 0.5, area = 4, eye = 0.5;
    constexpr std::size_t seeds = 24;
    SceneMaker maker(32, 64);
    maker.look({0, eye, 0}, {0, 0, 0}, 2 * std::atan(1 / eye) * 180 / pi, {0, 0, 1});
    maker.floor(-1, 1, 1, maker.material(diffuse(albedo)));
    GetParam().furnish(maker);
    maker.scene.settings.max_depth = 6;
    maker.scene.settings.rr_depth = 5;
    std::vector<double> means;
    for (const Image &image : render_seeds(maker.scene, seeds))
        means.push_back(spread_of(image).mean * pi / albedo * area);
    const Spread by_camera = spread_of(means);

    constexpr std::uint32_t count = 4 * many;
    LightPathsCase light(maker.scene);
    const Spread by_light =
        flux(light.trace(0, count), count, [](const Photon &p) { return std::fabs(p.position[1]) < 1e-4; });
    const double error = std::hypot(by_camera.standard_error, by_light.standard_error);
    EXPECT_NEAR(by_light.mean, by_camera.mean, 5 * error)
        << "errors " << by_camera.standard_error << " and " << by_light.standard_error;
    // The test can tell errors of some hundredths; those that it is for are larger.
    EXPECT_LT(error, 0.006 * by_camera.mean);
}

INSTANTIATE_TEST_SUITE_P(Flux, LightPathsAndPathTracer, ::testing::ValuesIn(agreements),
                         [](const auto &info) { return std::string(info.param.name); });
INSTANTIATE_TEST_SUITE_P(Full, LightPathsAndPathTracer, ::testing::ValuesIn(full_agreements),
                         [](const auto &info) { return std::string(info.param.name); });

/// A room with all kinds of lights, a smooth mesh in glass, metals, and things that are too smooth to gather at.
Scene room_of_everything() {
    SceneMaker maker(8, 1);
    maker.cube(maker.material(two_sided(diffuse(0.7))), -1, true);
    maker.lamp({0.2f, 0.9f, 0}, 0.5f, 0.25f, 3, maker.material(diffuse(0.2)));
    maker.sphere({-0.6f, -0.5f, 0.2f}, 0.3f, maker.material(glass(1.5)));
    maker.sphere({0.6f, -0.6f, 0.1f}, 0.3f, maker.material(rough_metal(0.02)));
    maker.sphere({0.1f, 0.1f, 0.4f}, 0.2f, maker.material(rough_glass(0.3, 1.5)));
    maker.sphere({0.5f, 0.6f, -0.5f}, 0.1f, maker.material(diffuse(0.5)),
                 maker.emitter(Emitter::Kind::area, {1, 2, 3}));
    maker.point_light({0.3f, 0.2f, 0.1f}, {-0.5f, 0.5f, -0.5f});
    maker.directional_light({1, 1, 0.5f}, {0, -1, 0});
    maker.environment(0.5);
    maker.scene.settings.rr_depth = 5;
    return maker.scene;
}

// Whatever the batch, and wherever a call begins: the same photons, to the last bit and in the same order.
TEST(LightPathsOf, AnyBatchAreTheSame) {
    const Scene scene = room_of_everything();
    constexpr std::uint32_t count = 20'000, middle = 7'001;
    constexpr std::uint64_t first = (std::uint64_t(1) << 32) - 1000; // across the words of a number
    RenderOptions options;
    options.seed = 3;
    LightPathsCase all(scene, options);
    const std::vector<Photon> photons = all.trace(first, count);
    EXPECT_EQ(all.paths.photons(), photons.size());
    ASSERT_GT(photons.size(), count / 2);
    for (std::size_t i = 1; i < photons.size(); ++i)
        ASSERT_TRUE(photons[i - 1].slot < photons[i].slot ||
                    (photons[i - 1].slot == photons[i].slot && photons[i - 1].depth < photons[i].depth));
    for (const std::uint32_t batch : {64u, 1000u, 65'536u}) {
        options.batch_size = batch;
        LightPathsCase other(scene, options);
        EXPECT_TRUE(other.trace(first, count) == photons) << batch;
        // Two calls are one.
        std::vector<Photon> parts = other.trace(first, middle);
        for (Photon photon : other.trace(first + middle, count - middle)) {
            photon.slot += middle;
            parts.push_back(photon);
        }
        EXPECT_TRUE(parts == photons) << batch;
        EXPECT_EQ(other.paths.light_paths(), 2u * count);
    }
    options.seed = 4;
    EXPECT_FALSE(LightPathsCase(scene, options).trace(first, count) == photons);
}

// Who samples lights himself gets all photons but the direct ones, the same ones.
TEST(LightPathsOf, LightsSampledElsewhereLeaveNoDirectPhotons) {
    const Scene scene = room_of_everything();
    constexpr std::uint32_t count = 5'000;
    std::vector<Photon> all = LightPathsCase(scene).trace(0, count);
    const std::size_t direct = std::erase_if(all, [](const Photon &photon) { return photon.depth == 1; });
    EXPECT_GT(direct, 0u);
    EXPECT_TRUE(LightPathsCase(scene, {}, LightPaths::Direct::left_out).trace(0, count) == all);
}

// Photons lie on rough surfaces alone, and on the side where they count.
TEST(LightPathsOf, AnySceneLeavePhotonsWhereTheyAreGathered) {
    const Scene scene = room_of_everything();
    RenderOptions options;
    std::size_t found[3] = {};
    for (const double roughness : {0.01, 0.05, 0.5}) {
        options.gather_roughness = roughness;
        const auto on_sphere = [&](const Photon &photon, std::size_t number) {
            const Sphere &sphere = scene.spheres[number];
            return std::fabs(std::hypot(photon.position[0] - sphere.center.x, photon.position[1] - sphere.center.y,
                                        photon.position[2] - sphere.center.z) -
                             sphere.radius) < 1e-4;
        };
        for (std::size_t &count : found)
            count = 0;
        bool is_inside_glass = false;
        for (const Photon &photon : LightPathsCase(scene, options).trace(0, 50'000)) {
            const double side =
                photon.wi[0] * photon.normal[0] + photon.wi[1] * photon.normal[1] + photon.wi[2] * photon.normal[2];
            for (std::size_t number = 0; number < 3; ++number)
                found[number] += on_sphere(photon, number);
            if (on_sphere(photon, 2))
                is_inside_glass |= side < 0;
            else
                ASSERT_GT(side, 0);
        }
        EXPECT_EQ(found[0], 0u) << "smooth glass";
        EXPECT_EQ(found[1] > 0, roughness <= 0.02) << "metal of roughness 0.02";
        EXPECT_EQ(found[2] > 0, roughness <= 0.3) << "glass of roughness 0.3";
        EXPECT_EQ(is_inside_glass, roughness <= 0.3);
    }
}

// About five photons a pixel of the film by default, as a pilot says that is the same for all batches; else what is
// asked for, and the table of photons grows.
TEST(LightPathsOf, APassAreAsManyAsStoreFivePhotonsAPixel) {
    Scene scene = room_of_everything();
    scene.film.width = scene.film.height = 256;
    scene.film.crop_width = scene.film.crop_height = 8;
    RenderOptions options;
    LightPathsCase light(scene, options);
    const std::uint32_t count = light.paths.paths_a_pass();
    EXPECT_EQ(light.paths.light_paths(), 0u);
    EXPECT_NEAR(double(light.trace(0, count).size()), 5 * 256 * 256, 0.05 * 5 * 256 * 256);
    options.batch_size = 4096;
    EXPECT_EQ(LightPathsCase(scene, options).paths.paths_a_pass(), count);
    options.photons = 3000;
    LightPathsCase few(scene, options);
    EXPECT_EQ(few.paths.paths_a_pass(), 3000u);
    std::vector<Photon> more = light.trace(5, 20'000);
    ASSERT_GT(more.size(), 3300u); // what there was room for at first
    EXPECT_TRUE(few.trace(5, 20'000) == more);
}

TEST(LightPathsOf, ADarkSceneAreNone) {
    SceneMaker maker = black_floor();
    LightPathsCase dark(maker.scene);
    EXPECT_EQ(dark.trace(0, 1000).size(), 0u);
    maker.lamp({0, 1, 0}, 1, 1, 1, 0);
    maker.scene.settings.max_depth = 1; // an edge from the light and one to the camera are two
    EXPECT_EQ(LightPathsCase(maker.scene).trace(0, 1000).size(), 0u);
    maker.scene.settings.max_depth = 2;
    EXPECT_GT(LightPathsCase(maker.scene).trace(0, 1000).size(), 0u);
}

// Double and float trace the same light paths but for rounding.
TEST(LightPathsOf, DoublePrecisionAreTheSameButForRounding) {
    SceneMaker maker(4, 1);
    maker.cube(maker.material(diffuse(0.6)), -1, true);
    maker.lamp({0, 0.9f, 0}, 0.5f, 0.25f, 1, maker.material(diffuse(0.5)));
    maker.scene.settings.rr_depth = 5;
    const Scene &scene = maker.scene;
    RenderOptions options;
    constexpr std::uint32_t count = 100'000;
    const auto power = [](const Photon &) { return 1.0; };
    const Spread single = flux(LightPathsCase(scene, options).trace(0, count), count, power);
    options.precision = Precision::double_;
    const Spread wide = flux(LightPathsCase(scene, options).trace(0, count), count, power);
    EXPECT_NEAR(single.mean, wide.mean, single.standard_error);
    EXPECT_NE(single.mean, wide.mean);
}

} // namespace
} // namespace gradus::testing
