// Light through surfaces with holes, which rays pass by chance, by every method.
#include "tests/methods/gradient_bias.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

#include <memory>
#include <utility>

namespace gradus::testing {
namespace {

Material black_screen(float opacity) {
    Material material = material_of(diffuse(0));
    material.opacity = opacity;
    return material;
}

/// A floor under a lamp, with a black screen between them that some of the light passes, seen from below the screen;
/// no light but the lamp's own reaches it.
Scene screened_floor(float opacity, std::uint64_t samples) {
    SceneMaker maker(16, samples);
    maker.floor(-4, 4, 4, maker.material(diffuse(0.5)));
    maker.lamp({0, 3, 0}, 4, 4, 1, maker.material(diffuse(0)));
    if (opacity > 0)
        maker.parallelogram({-4, 2, -4}, {8, 0, 0}, {0, 0, 8}, maker.material(black_screen(opacity)));
    maker.look({0, 1, -1}, {0, 0, 0}, 40);
    maker.scene.settings.max_depth = 2;
    return maker.scene;
}

class ThroughAScreen : public ::testing::TestWithParam<const char *> {};

// Light samples, directions of the BSDF and photons find the lamp with the same chance, so the weights of both need not
// know of the screen.
TEST_P(ThroughAScreen, LightIsWhatItsHolesLetThrough) {
    constexpr float opacity = 0.3f;
    const std::string method = GetParam();
    std::vector<RenderOptions::Strategy> strategies{RenderOptions::Strategy::mis};
    if (method != "sppm")
        strategies.push_back(RenderOptions::Strategy::bsdf);
    const std::uint64_t samples = method == "sppm" ? 8 : 512;
    for (const auto strategy : strategies) {
        RenderOptions options;
        options.strategy = strategy;
        options.photons = 200'000;
        const Image open = render(screened_floor(0, samples), options, method.c_str()).image;
        options.seed = 2;
        const Image screened = render(screened_floor(opacity, samples), options, method.c_str()).image;
        const Spread a = spread_of(open), b = spread_of(screened);
        fmt::print("{}: {:.4f} of the light passes\n", method, b.mean / a.mean);
        const double error = std::hypot(b.standard_error / a.mean, a.standard_error * b.mean / (a.mean * a.mean));
        EXPECT_NEAR(b.mean / a.mean, 1 - opacity, 4 * error) << int(strategy);
        EXPECT_LT(error, 0.015); // a screen that one sampler does not see would be 0.3 off, or its weights a part of it
    }
}

INSTANTIATE_TEST_SUITE_P(Methods, ThroughAScreen, ::testing::Values("pt", "gpt", "sppm"));

/// A black ball of opacity 0.5 before light from everywhere, met on both of its sides as the loader has it: a quarter
/// of the light comes through.
TEST(HalfOpenBall, IsPassedOnEachSideByItself) {
    SceneMaker maker(8, 1024);
    maker.look({0, 0, -4}, {0, 0, 0}, 8); // within the ball
    maker.environment(1);
    const std::uint32_t material = maker.material(black_screen(0.5f));
    for (const Sphere::Side side : {Sphere::Side::entered, Sphere::Side::left}) {
        maker.sphere({0, 0, 0}, 1, material);
        maker.scene.spheres.back().side = side;
    }
    // From within there is one side to pass.
    SceneMaker away = maker;
    away.look({0, 0, -4}, {0, 0, -8}, 8);
    SceneMaker within = maker;
    within.look({0.1, 0.2, -0.3}, {0, 0, 1}, 8);
    for (const char *method : {"pt", "gpt"}) {
        RenderOptions options;
        options.reconstruction = Reconstruction::l2;
        // Of 65536 samples, a deviation of 0.5 at most; gpt's pixels share numbers.
        const double slack = std::string(method) == "gpt" ? 0.02 : 5 * 0.5 / 256;
        const auto mean_of = [&](const Scene &scene) {
            const Image image = render(scene, options, method).image;
            double mean = 0;
            for (const float value : image.find("R")->values)
                mean += value / 64;
            return mean;
        };
        const double light = mean_of(away.scene);
        EXPECT_NEAR(mean_of(maker.scene) / light, 0.25, slack) << method;
        EXPECT_NEAR(mean_of(within.scene) / light, 0.5, slack) << method;
    }
}

/// A white ball with holes by a texture, turned, before light from everywhere: it is not to be seen. Where rays in and
/// rays out, of whatever length, did not find the same holes, it would be.
TEST(PaintedBall, IsLostInAFurnace) {
    SceneMaker maker(8, 2048);
    maker.look({0, 0, -4}, {0, 0, 0}, 20); // the ball is wider
    maker.environment(1);
    Bitmap bitmap;
    bitmap.resize(2, 2, Bitmap::Format::byte, false);
    for (std::uint32_t i = 0; i < 4; ++i)
        bitmap.set(i % 2, i / 2, 0, 80 * i);
    Texture holes;
    holes.bitmap = std::make_shared<const Bitmap>(std::move(bitmap));
    holes.is_nearest = true;
    maker.scene.textures = {holes};
    Material white = two_sided(diffuse(1));
    white.opacity.texture = 0;
    const std::uint32_t material = maker.material(white);
    for (const Sphere::Side side : {Sphere::Side::entered, Sphere::Side::left}) {
        maker.sphere({0, 0, 0}, 1, material);
        maker.scene.spheres.back().side = side;
        maker.scene.spheres.back().axes = {Vector3{0, 0.6f, 0.8f}, Vector3{1, 0, 0}, Vector3{0, 0.8f, -0.6f}};
    }
    maker.scene.settings.max_depth = -1;
    maker.scene.settings.rr_depth = 1000;
    for (const char *method : {"pt", "gpt"}) {
        RenderOptions options;
        options.reconstruction = Reconstruction::l2;
        const Spread light = spread_of(render(maker.scene, options, method).image);
        fmt::print("{}: {:.4f} +- {:.4f}\n", method, light.mean, light.standard_error);
        EXPECT_NEAR(light.mean, 1, 0.004) << method; // five standard errors
    }
}

// A fence of screens, some open, some half open, before a wall: seen through, and between the lamp and the wall.
TEST(GradientStability, ThroughSurfacesThatAreHalfOpen) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.7)));
    scene.parallelogram({-2, -2, 0}, {0, 4, 0}, {4, 0, 0}, grey);
    Material half = two_sided(diffuse(0.8));
    half.opacity = 0.5f;
    const std::uint32_t screen = scene.material(half);
    for (int i = 0; i < 4; ++i)
        scene.parallelogram({0.3f * float(i) - 0.6f, -0.5f, -0.4f}, {0, 1, 0}, {0.15f, 0, 0}, screen);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {20, 20, 20});
    scene.parallelogram({0.6f, 1, -2}, {0, -0.5f, 0}, {0.5f, 0, 0}, grey, light);
    scene.look({0, 0, -3}, {0, 0, 0}, 22);
    expect_no_bias(gradient_bias(scene.scene, {16, 48, 128}),
                   {"Gradients", "opacity by chance: base and offset path meet a surface or pass it each on its own",
                    "half open cards before a wall, in the way of light and of the camera",
                    "visibility by a hash of each ray; unbiased", 0.1});
}

} // namespace
} // namespace gradus::testing
