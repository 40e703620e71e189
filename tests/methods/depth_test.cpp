// max_depth, rr_depth and hide_emitters, and direct light against closed forms.
#include "tests/io/scene_text.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

constexpr double albedo = 0.6;

/// The plane y = 0, its front up, and a camera that sees all but one point of it.
SceneMaker plane_seen_at(const Double3 &target, std::uint64_t samples = 4) {
    SceneMaker maker(2, samples);
    maker.look({-1, 2, -3}, target, 0.001);
    maker.parallelogram({-20, 0, -20}, {0, 0, 40}, {40, 0, 0}, maker.material(diffuse(albedo)));
    maker.scene.settings.max_depth = 2;
    return maker;
}

const Double3 targets[] = {{0, 0, 0}, {1.5, 0, 0.25}, {-2, 0, 1}, {0.3, 0, -0.9}, {6, 0, -5}};

void expect_all(const Image &image, double expected, double relative) {
    EXPECT_NEAR(spread_of(image).least, expected, relative * expected);
    EXPECT_NEAR(spread_of(image).most, expected, relative * expected);
}

TEST(DirectLight, OfAPointIsExact) {
    const Double3 light{0.3, 1.5, -0.2};
    for (const Double3 &target : targets) {
        SceneMaker maker = plane_seen_at(target);
        maker.point_light({2, 3, 5}, to_float(light));
        const Image image = render(maker.scene).image;
        const double distance = length(subtract(light, target)), cosine = light[1] / distance;
        const double expected = albedo / M_PI * cosine / (distance * distance);
        expect_all(image, 3 * expected, 1e-4);
        EXPECT_NEAR(pixel(image, 0, 0, "R"), 2 * expected, 2e-4 * expected);
        EXPECT_NEAR(pixel(image, 0, 0, "B"), 5 * expected, 5e-4 * expected);
    }
}

TEST(DirectLight, OfADirectionIsExact) {
    const Double3 travels = normalize({0.5, -1, -0.6});
    for (const Double3 &target : targets) {
        SceneMaker maker = plane_seen_at(target);
        maker.directional_light({1, 4, 2}, to_float(travels));
        expect_all(render(maker.scene).image, 4 * albedo / M_PI * -travels[1], 1e-5);
    }
}

TEST(DirectLight, IsBlockedByWhatIsBetweenAndByNothingElse) {
    const auto value = [](double blocker_height, bool behind_the_plane) {
        SceneMaker maker = plane_seen_at({0, 0, 0});
        maker.point_light({1, 1, 1}, {0, behind_the_plane ? -2.0f : 2.0f, 0});
        if (blocker_height > 0)
            maker.sphere({0, float(blocker_height), 0}, 0.1f, maker.material(diffuse(0)));
        return spread_of(render(maker.scene).image).most;
    };
    const double open = albedo / M_PI / 4;
    EXPECT_NEAR(value(0, false), open, 1e-4 * open);
    EXPECT_EQ(value(1, false), 0);
    EXPECT_NEAR(value(3, false), open, 1e-4 * open) << "beyond the light";
    EXPECT_EQ(value(0, true), 0) << "behind the surface";
}

TEST(DirectLight, OfADirectionIsBlockedFarAway) {
    SceneMaker maker = plane_seen_at({0, 0, 0});
    maker.directional_light({1, 1, 1}, {0, -1, 0});
    maker.sphere({0, 500, 0}, 0.1f, maker.material(diffuse(0)));
    EXPECT_EQ(spread_of(render(maker.scene).image).most, 0);
}

/// Lambert's formula: irradiance on the plane at `target` by a polygon of radiance 1 above it.
double polygon_irradiance(const Double3 &target, const std::vector<Double3> &corners) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Double3 a = normalize(subtract(corners[i], target));
        const Double3 b = normalize(subtract(corners[(i + 1) % corners.size()], target));
        const Double3 axis = cross(a, b);
        sum += std::atan2(length(axis), dot(a, b)) * axis[1] / length(axis);
    }
    return std::fabs(sum) / 2;
}

class DirectAreaLight : public ::testing::TestWithParam<const char *> {
  protected:
    static RenderOptions::Strategy strategy() {
        const std::string name = GetParam();
        return name == "mis"     ? RenderOptions::Strategy::mis
               : name == "light" ? RenderOptions::Strategy::light
                                 : RenderOptions::Strategy::bsdf;
    }
};

/// Pixels of one value each, so their spread is the noise.
Spread render_with(Scene scene, RenderOptions::Strategy strategy) {
    scene.film.width = scene.film.height = 32;
    scene.settings.samples_per_pixel = 256;
    RenderOptions options;
    options.strategy = strategy;
    return spread_of(render(scene, options).image);
}

TEST_P(DirectAreaLight, OfARectangleFollowsLambert) {
    for (const Double3 &target : targets) {
        SceneMaker maker = plane_seen_at(target);
        const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {3, 3, 3});
        // Its front down.
        maker.parallelogram({-1, 2, 0}, {2, 0.5f, 0}, {0, 0, 1.5f}, maker.material(diffuse(0)), emitter);
        const double expected =
            3 * albedo / M_PI * polygon_irradiance(target, {{-1, 2, 0}, {1, 2.5, 0}, {1, 2.5, 1.5}, {-1, 2, 1.5}});
        const Spread spread = render_with(maker.scene, strategy());
        EXPECT_LT(spread.standard_error, 0.05 * expected);
        EXPECT_NEAR(spread.mean, expected, 4 * spread.standard_error + 1e-5 * expected);
    }
}

TEST_P(DirectAreaLight, OfASphereFollowsTheInverseSquare) {
    const Double3 center{0.5, 2, 0.5};
    for (const double radius : {0.05, 0.5, 1.5}) {
        for (const Double3 &target : {targets[0], targets[1], targets[3]}) {
            SceneMaker maker = plane_seen_at(target);
            const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {3, 3, 3});
            maker.sphere(to_float(center), float(radius), maker.material(diffuse(0)), emitter);
            const double distance = length(subtract(center, target)), cosine = center[1] / distance;
            if (radius > center[1] - 0.1 || (radius == 0.05 && strategy() == RenderOptions::Strategy::bsdf))
                continue; // below the plane in part, or never met
            const double expected = 3 * albedo * cosine * radius * radius / (distance * distance);
            const Spread spread = render_with(maker.scene, strategy());
            EXPECT_LT(spread.standard_error, 0.02 * expected);
            EXPECT_NEAR(spread.mean, expected, 4 * spread.standard_error + 1e-4 * expected)
                << "radius " << radius << " at " << target[0];
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Strategies, DirectAreaLight, ::testing::Values("mis", "light", "bsdf"));

/// A lamp that fills the left half of the image, before a plane lit by it that fills the right half.
Scene lamp_and_wall() {
    SceneMaker maker(16, 16);
    maker.look({0, 0, -4}, {0, 0, 0}, 30); // +x is to the left
    const std::uint32_t white = maker.material(diffuse(0.8));
    const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {2, 3, 4});
    maker.parallelogram({0, -5, 0}, {0, 10, 0}, {5, 0, 0}, white, emitter); // faces -z
    maker.parallelogram({-5, -5, 1}, {0, 10, 0}, {5, 0, -1}, white);        // faces -z and a bit +x
    return maker.scene;
}

TEST(MaxDepth, OneShowsEmittersOnly) {
    Scene scene = lamp_and_wall();
    for (const int depth : {0, 1}) {
        scene.settings.max_depth = depth;
        const Image image = render(scene).image;
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 0; x < 16; ++x) {
                ASSERT_EQ(pixel(image, x, y, "R"), depth == 1 && x < 8 ? 2 : 0) << x << ", " << y;
                ASSERT_EQ(pixel(image, x, y, "B"), depth == 1 && x < 8 ? 4 : 0) << x << ", " << y;
            }
    }
}

TEST(MaxDepth, HiddenEmittersStillLight) {
    // A lamp before a wall; hidden, its light on the wall stays, and the wall behind it is seen.
    SceneMaker maker(16, 64);
    maker.look({0, 0, -4}, {0, 0, 0}, 30);
    const std::uint32_t white = maker.material(diffuse(0.8));
    maker.parallelogram({-5, -5, 0}, {0, 10, 0}, {10, 0, 0}, white);
    maker.sphere({0.4f, 0.3f, -1.5f}, 0.3f, white, maker.emitter(Emitter::Kind::area, {5, 5, 5}));
    maker.scene.settings.max_depth = 2;
    Scene hidden = maker.scene;
    hidden.settings.hide_emitters = true;
    for (const char *method : {"pt", "gpt", "sppm"}) {
        RenderOptions options;
        options.photons = 2000;
        options.reconstruction = Reconstruction::l2;
        const Image shown = render(maker.scene, options, method).image, seen = render(hidden, options, method).image;
        std::size_t lamp = 0;
        for (std::uint32_t y = 0; y < 16; ++y)
            for (std::uint32_t x = 0; x < 16; ++x)
                if (pixel(shown, x, y) > 4.99) { // all of the pixel is lamp
                    ++lamp;
                    // Of radiance L and radius r, at distance d from a point that is h before it: albedo L r^2 h / d^3.
                    // What is behind the lamp lies 0.8 beside its foot at most.
                    const auto lit = [](double aside) {
                        return 0.8 * 5 * 0.09 * 1.5 / std::pow(std::hypot(1.5, aside), 3);
                    };
                    EXPECT_GT(pixel(seen, x, y), 0.9 * lit(0.8)) << method;
                    EXPECT_LT(pixel(seen, x, y), 1.1 * lit(0)) << method;
                }
        EXPECT_GT(lamp, 0u) << method;
        EXPECT_NEAR(pixel(seen, 0, 15), pixel(shown, 0, 15), 0.02) << method << ": the wall is lit";
    }
}

TEST(MaxDepth, HiddenLampsAreHiddenWhateverTheyEmit) {
    // A card and a ball before a wall that a point light lights, both lamps of this radiance.
    const auto image_of = [](const char *radiance, bool hidden) {
        const std::string lamp = fmt::format(
            R"(<emitter type="area"><rgb name="radiance" value="{}"/></emitter><bsdf type="diffuse"/></shape>)",
            radiance);
        LoadedScene loaded = load_text(
            R"(<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="20"/>
               <transform name="to_world"><lookat origin="0,0,5" target="0,0,0" up="0,1,0"/></transform>
               <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
               <shape type="rectangle"><transform name="to_world"><scale value="2"/></transform></shape>
               <shape type="rectangle"><transform name="to_world"><translate x="1" z="3"/></transform>)" +
            lamp + R"(<shape type="sphere"><point name="center" x="-0.5" z="3"/><float name="radius" value="0.4"/>)" +
            lamp + R"(<emitter type="point"><point name="position" z="2"/></emitter></scene>)");
        loaded.scene.settings.max_depth = 2;
        loaded.scene.settings.samples_per_pixel = 1024;
        loaded.scene.settings.hide_emitters = hidden;
        return render(loaded.scene).image;
    };
    const Image black = image_of("0", true), dim = image_of("1e-8", true), shown = image_of("0", false);
    for (std::uint32_t y = 0; y < 8; ++y)
        for (std::uint32_t x = 0; x < 8; ++x) {
            // A third of the light samples go to the lamps of 1e-8 and find nothing. The light of the other samples
            // counts 3/2: of 1024 a pixel that is a deviation of 2.2 %, five of which come once in 20,000 tests.
            EXPECT_NEAR(pixel(black, x, y), pixel(dim, x, y), 0.11 * pixel(black, x, y)) << x << ", " << y;
            EXPECT_GT(pixel(black, x, y), 0.01) << x << ", " << y;
        }
    EXPECT_EQ(pixel(shown, 7, 4), 0);
    EXPECT_LT(pixel(shown, 2, 4), 0.5 * pixel(black, 2, 4)) << "what the lamps reflect is seen where they are";
}

TEST(RussianRoulette, LeavesTheMeanAlone) {
    Scene scene = own_scene("cornell-box.xml", 48, 48);
    scene.settings.samples_per_pixel = 32;
    scene.settings.max_depth = 8;
    const auto images = [&](int rr_depth, std::uint64_t first) {
        scene.settings.rr_depth = rr_depth;
        return render_seeds(scene, 10, {}, first);
    };
    const std::vector<Image> off = images(-1, 1);
    EXPECT_TRUE(agree("roulette-from-1", images(1, 100), off, 32));
    EXPECT_TRUE(agree("roulette-from-5", images(5, 200), off, 32));
}

TEST(RussianRoulette, LeavesTheMeanAloneInGlass) {
    SceneMaker maker(32, 1024);
    maker.look({0, 0, -3}, {0, 0, 0}, 28);
    maker.sphere({0, 0, 0}, 1, maker.material(glass(1.5046)));
    maker.environment(1);
    maker.scene.settings.rr_depth = 1;
    const Spread spread = spread_of(render(maker.scene).image);
    EXPECT_GT(spread.standard_error, 0);
    EXPECT_NEAR(spread.mean, 1, 4 * spread.standard_error);
}

// A closed room: a path of throughput a^k after k bounces. Roulette begins with the bounce number rr_depth and
// leaves a path alive with its throughput, which is 1 thereafter: of what reaches it, a^rr_depth go on, and then a of
// those each time. So rr_depth + a^rr_depth / (1 - a) segments a path, or max_depth where there is no roulette.
TEST(RussianRoulette, BeginsAtItsDepth) {
    constexpr double a = 0.5;
    SceneMaker maker(32, 64);
    maker.look({0.2, -0.1, -0.3}, {0.3, 0.2, 1}, 90);
    maker.cube(maker.material(diffuse(a)), maker.emitter(Emitter::Kind::area, {1, 1, 1}), true);
    maker.scene.settings.max_depth = 60;
    RenderOptions options;
    options.strategy = RenderOptions::Strategy::bsdf;
    const double samples = 32 * 32 * 64;
    for (const int rr_depth : {1, 2, 3, 5, 8}) {
        maker.scene.settings.rr_depth = rr_depth;
        const Statistics statistics = render(maker.scene, options).statistics;
        const double segments = double(statistics.rays.at("extension")) / samples;
        const double go_on = std::pow(a, rr_depth);
        // Variance of a geometric count that begins with probability go_on: below its second moment, go_on (1 + a) /
        // (1 - a)^2.
        const double error = std::sqrt(go_on * (1 + a) / ((1 - a) * (1 - a)) / samples);
        EXPECT_NEAR(segments, rr_depth + go_on / (1 - a), 4 * error) << "rr_depth " << rr_depth;
    }
    maker.scene.settings.rr_depth = -1;
    // Of 3e7 rays that start at a wall one misses the next wall: it starts at the very edge where both meet, nearer
    // than rounding tells apart. So a path in 500,000 is lost, whatever the distance by which rays start off their own
    // wall.
    const double rays = double(render(maker.scene, options).statistics.rays.at("extension"));
    EXPECT_LE(rays, 60 * samples);
    EXPECT_GE(rays, 60 * (samples - 8));
}

} // namespace
} // namespace gradus::testing
