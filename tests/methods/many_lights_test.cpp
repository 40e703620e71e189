// Scenes of many lights, of all kinds, chosen from by a tree: what it chooses is weighted as what is found.
#include "tests/methods/gradient_bias.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"
#include "tests/support/textures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gradus::testing {
namespace {

struct LampKinds {
    bool balls = false, textures = false, points = false, far = false;
};

/// Tiles that shine down on a floor close below them, so that light samples and sampled directions find them about as
/// often, and that each place prefers others; among them balls that shine out or inwards, points, spots and what is at
/// infinity; a card that stands between, and a ball of metal.
SceneMaker room_of_lamps(const LampKinds &kinds, bool is_glossy = true) {
    SceneMaker maker(32, 16);
    maker.scene.settings.max_depth = 4;
    maker.look({0, 0.45, 2.2}, {0, 0.1, 0}, 50);
    const std::uint32_t grey = maker.material(two_sided(diffuse(0.6))), black = maker.material(diffuse(0));
    maker.floor(-3, 3, 3, grey);
    maker.parallelogram({-0.6f, 0, -0.6f}, {0, 0.4f, 0}, {0.4f, 0, 0.4f}, grey);
    maker.sphere({0.7f, 0.2f, 0.3f}, 0.2f, is_glossy ? maker.material(rough_metal(0.15)) : grey);
    std::mt19937 engine(4);
    const auto uniform = [&](float low, float high) {
        return low + (high - low) * float(engine() >> 8) * float(0x1p-24);
    };
    const auto color = [&] { return Rgb{uniform(0.1f, 3), uniform(0.1f, 3), uniform(0.1f, 3)}; };
    std::int32_t texture = no_texture;
    if (kinds.textures) {
        maker.scene.textures.push_back(random_texture(4, 3, Bitmap::Format::half, true, 3));
        maker.scene.textures.back().highest = 1e30f;
        texture = 0;
    }
    for (int i = 0; i < 96; ++i) {
        const Vector3 p{-2 + 0.33f * float(i % 12), uniform(0.5f, 0.7f), -2 + 0.33f * float(i / 12)};
        const std::int32_t lamp = maker.emitter(Emitter::Kind::area, color());
        maker.scene.emitters.back().texture = i % 2 ? texture : no_texture;
        if (kinds.balls && i % 3 == 0)
            maker.sphere(p, uniform(0.05f, 0.15f), black, lamp);
        else
            maker.parallelogram(p, {0.3f, uniform(-0.1f, 0.1f), 0}, {0, uniform(-0.1f, 0.1f), 0.3f}, black, lamp);
        if (kinds.points && i % 10 == 0) {
            maker.point_light({0.05f, 0.06f, 0.04f}, {p.x, p.y - 0.3f, p.z});
            maker.spot({0.3f, 0.2f, 0.3f}, {p.x, p.y - 0.1f, p.z}, {0, -1, 0}, 20, 40);
        }
    }
    if (kinds.balls) // around the camera's view: shines inwards
        maker.sphere({0, 0.5f, 0}, 6, black, maker.emitter(Emitter::Kind::area, {0.1f, 0.1f, 0.2f}), true);
    if (kinds.far) {
        maker.sphere({-0.25f, 0.15f, 0.6f}, 0.15f, maker.material(mirror())); // offset paths that stay apart
        maker.environment_map(16, 9,
                              [](std::uint32_t x, std::uint32_t y) { return 0.1 + 0.1 * ((x * 5 + y * 3) % 7); });
        maker.directional_light({0.5f, 0.4f, 0.2f}, {0.6f, -0.8f, 0});
    }
    return maker;
}

std::vector<Image> images_by(const Scene &scene, RenderOptions::Lights lights, std::uint64_t first,
                             RenderOptions::Strategy strategy = RenderOptions::Strategy::mis) {
    RenderOptions options;
    options.lights = lights;
    options.strategy = strategy;
    return render_seeds(scene, 8, options, first);
}

std::vector<double> means_of(const std::vector<Image> &images) {
    std::vector<double> means;
    for (const Image &image : images)
        means.push_back(spread_of(image).mean);
    return means;
}

TEST(ManyLights, LookTheSameByTreeAndByPower) {
    const Scene scene = room_of_lamps({}, false).scene;
    const std::vector<Image> tree = images_by(scene, RenderOptions::Lights::tree, 1);
    const std::vector<Image> power = images_by(scene, RenderOptions::Lights::power, 100);
    EXPECT_TRUE(agree("many-lights", tree, power, 16));
    // They would look the same, too, if the option did nothing.
    EXPECT_FALSE(equal_bits(tree[0], images_by(scene, RenderOptions::Lights::power, 1)[0]));

    const Spread by_tree = spread_of(means_of(tree)), by_power = spread_of(means_of(power));
    record_stability(
        {"Path tracing", "many lights: a place gets most of its light from a few of them",
         "96 tiles that shine on a floor close below them, 16 samples, 8 seeds",
         "chosen by a tree, and weighed by the same probabilities where they are met; from 16 emitters "
         "or 4096 lights on",
         "mean of the image less that by power, standard errors",
         std::fabs(by_tree.mean - by_power.mean) / std::hypot(by_tree.standard_error, by_power.standard_error), 4});
}

class ManyLightsOf : public ::testing::TestWithParam<LampKinds> {};

TEST_P(ManyLightsOf, LookTheSameHoweverTheyAreFound) {
    SceneMaker maker = room_of_lamps(GetParam());
    maker.scene.settings.samples_per_pixel = 64;
    const std::vector<Image> power = images_by(maker.scene, RenderOptions::Lights::power, 1);
    const std::vector<Image> tree = images_by(maker.scene, RenderOptions::Lights::tree, 100);
    EXPECT_TRUE(agree("many-lights-tree-and-power", tree, power, 64));
    const std::vector<Image> light =
        images_by(maker.scene, RenderOptions::Lights::tree, 200, RenderOptions::Strategy::light);
    EXPECT_TRUE(agree("many-lights-light-and-mis", light, tree, 64));
}

TEST_P(ManyLightsOf, HaveDifferencesWithoutBias) {
    SceneMaker maker = room_of_lamps(GetParam());
    // Large pixels: neighbours see other lamps above them. Between small ones the probabilities hardly differ.
    maker.scene.film.width = maker.scene.film.height = 8;
    const GradientBias bias =
        gradient_bias(maker.scene, {.seeds = 12, .gradient_domain = 2048, .path_tracing = 8192, .by_tree = true});
    for (const auto &[name, estimate] : {std::pair{"primal", bias.primal}, {"differences", bias.differences}}) {
        std::printf("%-11s squared bias %.1f standard errors, relative bias at most %.2g\n", name,
                    estimate.squared / estimate.standard_error, estimate.at_most());
        EXPECT_TRUE(estimate.is_none()) << name;
    }
}

INSTANTIATE_TEST_SUITE_P(Full, ManyLightsOf,
                         ::testing::Values(LampKinds{}, LampKinds{.balls = true},
                                           LampKinds{.textures = true, .points = true},
                                           LampKinds{.balls = true, .textures = true, .points = true, .far = true}),
                         [](const auto &info) {
                             return std::string(std::array{"Plates", "Balls", "PointsAndTextures", "All"}[info.index]);
                         });

} // namespace
} // namespace gradus::testing
