// Gradient-domain path tracing where differences are hard to estimate: edges, tiny lights, caustics, shadows. Samples
// and limits are such that planted defects show: one test of visibility for both paths in the shadows and at edges, a
// Jacobian without cosines at the tiny lamp, Dirac vertices that merge in the caustic.
#include "tests/methods/gradient_bias.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

constexpr const char *area = "Gradients";

/// z = 0, its front towards -z, where the camera is.
void add_wall(SceneMaker &scene, std::uint32_t material) {
    scene.parallelogram({-2, -2, 0}, {0, 4, 0}, {4, 0, 0}, material);
}

// Tilted cards of two greys float before a wall: depth, normal and albedo jump from pixel to pixel.
TEST(GradientStability, AtEdgesOfDepthNormalAndAlbedo) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t light_grey = scene.material(two_sided(diffuse(0.8)));
    const std::uint32_t dark_grey = scene.material(two_sided(diffuse(0.3)));
    add_wall(scene, light_grey);
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const float x = 0.25f * float(i) - 0.45f, y = 0.25f * float(j) - 0.45f,
                        z = -0.1f - 0.1f * float((i + j) % 3);
            scene.parallelogram({x, y, z}, {0.02f, 0.13f, 0.1f * float(i - 1)}, {0.13f, 0, 0.1f * float(j - 1)},
                                (i + j) % 2 ? light_grey : dark_grey);
        }
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {20, 20, 20});
    scene.parallelogram({1, 1, -3}, {0, -0.5f, 0}, {0.5f, 0, 0}, light_grey, light);
    scene.look({0, 0, -3}, {0, 0, 0}, 18);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "dipoles at edges of depth, normal and texture: base and offset path have little in common",
                    "tilted cards of two greys before a wall, each four or five pixels wide",
                    "shifts fail or weigh little there; primal and differences are unbiased", 0.1});
}

// A lamp of 2 mm that shines on a wall 5 cm away, as bright as it takes.
TEST(GradientStability, FromATinyBrightLight) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.8)));
    add_wall(scene, grey);
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {1e6f, 1e6f, 1e6f});
    // Its front is towards the wall.
    scene.parallelogram({0.6f, 0, -0.05f}, {0.002f, 0, 0}, {0, 0.002f, 0}, grey, light);
    scene.parallelogram({-0.6f, -1, -1}, {0, 0, 1}, {0, 2, 0}, grey); // what is found there lights the wall
    scene.look({0.1, 0, -3}, {0.1, 0, 0}, 15);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 256}),
                   {area, "tiny bright lights: BSDF sampling finds them once in a million paths, with a firefly",
                    "a lamp of 2 mm and radiance 1e6, 5 cm from a wall",
                    "light sampling, weighted against BSDF sampling of base and offset path; unbiased", 0.09});
}

// A sun of one texel, a million times its sky, behind cards: sharp shadows, and BSDF sampling that finds the sun once
// in ten thousand paths.
TEST(GradientStability, UnderASunOfOneTexel) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.6)));
    const std::uint32_t metal = scene.material(rough_metal(0.2));
    add_wall(scene, grey);
    scene.sphere({0.25f, -0.2f, -0.3f}, 0.22f, metal);
    scene.parallelogram({-0.5f, -0.3f, -0.4f}, {0.1f, 0.6f, 0.1f}, {0.3f, 0, -0.1f}, grey);
    scene.environment_map(64, 33, [](std::uint32_t x, std::uint32_t y) { return x == 5 && y == 10 ? 1e5 : 0.1; });
    scene.look({0.2, 0.1, -3}, {0, 0, 0}, 22);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "tiny bright pixels of an environment: BSDF sampling finds them seldom, with a firefly",
                    "a map of 64 x 33 texels of which one is a million times as bright, a card and a rough metal ball",
                    "directions are sampled by the bilinear map itself, weighted against BSDF sampling; unbiased",
                    0.079});
}

// What a mirror shows of a map: base and offset path leave the scene in directions of their own.
TEST(FullGradientStability, WhereAMirrorShowsAMap) {
    SceneMaker scene = scene_for_bias();
    add_wall(scene, scene.material(two_sided(diffuse(0.3))));
    scene.sphere({0, 0, -0.5f}, 0.45f, scene.material(mirror()));
    scene.environment_map(16, 9, [](std::uint32_t x, std::uint32_t y) { return 1 + (x * 5 + y * 3) % 7; });
    scene.look({0, 0.1, -3}, {0, 0, 0}, 18);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 128}),
                   {area, "an environment map in a mirror: every pixel sees another part of it",
                    "a mirror ball before a wall under a map of 16 x 9 texels between 1 and 7",
                    "offset paths that copy find the map's light in their own direction, with its density; unbiased",
                    0.15});
}

// The rim of a spot, hard and soft, on a wall: light samples beyond it have no density.
TEST(GradientStability, AtTheRimOfASpot) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.7)));
    add_wall(scene, grey);
    scene.parallelogram({-0.6f, -1, -1}, {0, 0, 1}, {0, 2, 0}, grey);
    scene.spot({5, 4, 3}, {0.1f, 0.2f, -1.5f}, {0, 0, 1}, 12, 12);
    scene.spot({1, 2, 4}, {-0.1f, -0.4f, -1.2f}, {0, 0.1961161f, 0.9805807f}, 5, 16);
    scene.look({0, 0, -3}, {0, 0, 0}, 20);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "a spot's rim: the light sample of one pixel is none of its neighbour's",
                    "two spots on two walls, one without a soft rim",
                    "beyond the rim there is no light sample, as behind a lamp; unbiased", 0.14});
}

// A green spot through a picture of red and green squares, each of two or three pixels.
TEST(GradientStability, InThePictureOfASpotOfItsOwnColor) {
    SceneMaker scene = scene_for_bias(2);
    scene.floor(-2, 2, 2, scene.material(two_sided(diffuse(0.7))));
    Texture squares;
    squares.kind = Texture::Kind::checkerboard;
    squares.color_0 = {1, 0, 0};
    squares.color_1 = {0.2f, 1, 0};
    squares.to_uv = {6, 0, 0, 0, 6, 0};
    scene.scene.textures.push_back(squares);
    Emitter &spot = scene.picture(Emitter::Kind::spot, {0, 5, 0}, 0, {0.1f, 2, 0.1f}, 0.7f, 0.6f);
    spot.cutoff = 0.5f;
    spot.beam = 0.1f;
    scene.look({0, 3, 0}, {0, 0, 0}, 40, {0, 0, 1});
    expect_no_bias(gradient_bias(scene.scene, {8, 32, 64}),
                   {area, "a picture that is not black and yet shows nothing of its light",
                    "a green spot through a picture of red and green squares",
                    "there is no light sample, as where a picture is black; unbiased", 0.14});
}

// A ball of glass between a lamp and the floor: light sampling cannot find the caustic.
TEST(GradientStability, InACaustic) {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.6)));
    scene.floor(-2, 2, 2, grey);
    scene.sphere({0, 0.6f, 0}, 0.4f, scene.material(glass(1.5)));
    scene.lamp({0, 2.5f, 0}, 1.4f, 1.4f, 6, grey);
    hide_all_kinds(scene);
    scene.look({0, 1.3, -2.6}, {0, 0.15, 0}, 30);
    expect_no_bias(gradient_bias(scene.scene, {8, 48, 96}),
                   {area, "caustics: reconnecting to a Dirac vertex carries nothing",
                    "a glass ball over a floor, and what lies behind it",
                    "copies half vectors along the chain, between rough vertices too; unbiased", 0.4});
}

// A card before a wall: at both edges of its shadow a pixel whose path sees the light has a neighbour whose path does
// not.
SceneMaker shadow() {
    SceneMaker scene = scene_for_bias();
    const std::uint32_t grey = scene.material(two_sided(diffuse(0.7)));
    add_wall(scene, grey);
    scene.parallelogram({-0.1f, -1, -1}, {0, 2, 0}, {0.2f, 0, 0}, grey); // half as wide as its shadow
    scene.look({0, 0, -0.9}, {0, 0, 0}, 40);                             // from behind the card
    return scene;
}

constexpr const char *one_sees = "the light hidden from the base path only and from the offset path only: one test of "
                                 "visibility for both would lose light, or make it";
constexpr const char *tests_both = "tests both paths; who does not see the light has contribution 0 there; unbiased";

TEST(GradientStability, AtTheHardShadowOfAPointLight) {
    SceneMaker scene = shadow();
    scene.point_light({30, 30, 30}, {0, 0, -2});
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, one_sees, "a card's shadow on a wall, by a point light", tests_both, 0.1});
}

TEST(GradientStability, AtTheShadowOfALamp) {
    SceneMaker scene = shadow();
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {8000, 8000, 8000});
    // Its front is towards the wall.
    scene.parallelogram({-0.03f, -0.03f, -2}, {0.06f, 0, 0}, {0, 0.06f, 0}, 0, light);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, one_sees, "a card's shadow on a wall, by a lamp", tests_both, 0.15});
}

// An environment and nothing else that shines: the same from everywhere, which no sampler needs to look for.
TEST(GradientStability, UnderAnEnvironmentAlone) {
    SceneMaker scene = scene_for_bias();
    add_wall(scene, scene.material(two_sided(diffuse(0.6))));
    scene.sphere({0.25f, -0.2f, -0.3f}, 0.22f, scene.material(rough_metal(0.2)));
    scene.parallelogram({-0.5f, -0.3f, -0.4f}, {0.1f, 0.6f, 0.1f}, {0.3f, 0, -0.1f}, 0);
    scene.environment(1);
    scene.look({0.2, 0.1, -3}, {0, 0, 0}, 22);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "an environment alone: half of the paths leave the scene at once",
                    "a wall, a card and a rough metal ball, the same light from everywhere",
                    "paths that leave copy their direction; light and BSDF sampling are weighted for both; unbiased",
                    0.25});
}

// A wall in tiles of two pixels and, before it, a card with holes of three, both by textures.
TEST(GradientStability, AtEdgesOfTexturesAndOpacity) {
    SceneMaker scene = scene_for_bias();
    const auto add_texture = [&](const std::shared_ptr<const Bitmap> &bitmap) {
        Texture texture;
        texture.bitmap = bitmap;
        texture.is_nearest = true;
        scene.scene.textures.push_back(texture);
        return std::int32_t(scene.scene.textures.size() - 1);
    };
    Bsdf tiles = diffuse(0.5);
    tiles.reflectance.texture = add_texture(random_bitmap(64, 64, Bitmap::Format::byte, true));
    add_wall(scene, scene.material(two_sided(tiles, tiles)));
    const auto holes = std::make_shared<Bitmap>();
    holes->resize(8, 8, Bitmap::Format::byte, false);
    for (std::uint32_t i = 0; i < 64; ++i)
        holes->set(i % 8, i / 8, 0, (i * 37 + i / 8) % 3 == 0 ? 0 : 255);
    Material screen = two_sided(diffuse(0.8));
    screen.opacity = 0;
    screen.opacity.texture = add_texture(holes);
    scene.parallelogram({-0.4f, -0.4f, -0.3f}, {0, 0.8f, 0.05f}, {0.8f, 0, 0}, scene.material(screen));
    const std::int32_t light = scene.emitter(Emitter::Kind::area, {20, 20, 20});
    scene.parallelogram({1, 1, -3}, {0, -0.5f, 0}, {0.5f, 0, 0}, scene.material(diffuse(0.5)), light);
    scene.look({0, 0, -3}, {0, 0, 0}, 18);
    expect_no_bias(gradient_bias(scene.scene, {8, 16, 64}),
                   {area, "edges of textures and of opacity: no geometry tells them",
                    "a wall in tiles of two pixels and a card with holes of three, by textures",
                    "each offset path reads its own place, and passes what is open there; unbiased", 0.1});
}

/// A floor under a normal map and, before it, a ball that mirrors under a bump map; the first is near or the second.
class NormalMapStability : public ::testing::TestWithParam<const char *> {};

TEST_P(NormalMapStability, IsUnbiased) {
    const bool is_mirror = std::string(GetParam()) == "mirror";
    SceneMaker scene = scene_for_bias();
    const auto map_of = [&](NormalTexture::Kind kind, unsigned seed, float up) {
        Texture texture = random_texture(5, 5, Bitmap::Format::real, true, seed);
        texture.lowest = -1e30f;
        texture.highest = 1e30f;
        texture.scale = {1, 1, up};
        NormalTexture map;
        map.kind = kind;
        map.texture = std::int32_t(scene.scene.textures.size());
        map.scale = 0.1f;
        map.turns_over = map.shadows = true;
        scene.scene.textures.push_back(texture);
        return map;
    };
    Bsdf floor = diffuse(0.7), ball;
    ball.kind = BsdfKind::conductor;
    floor.map = map_of(NormalTexture::Kind::normal, 1, is_mirror ? 2 : 1);
    ball.map = map_of(NormalTexture::Kind::bump, 2, 1);
    scene.floor(-2, 2, 2, scene.material(two_sided(floor, floor)));
    scene.sphere({0.2f, 0.4f, 0}, is_mirror ? 0.4f : 0.15f, scene.material(ball));
    scene.lamp({0.5f, 2, 0}, 0.8f, 0.8f, 6, scene.material(diffuse(0)));
    scene.look({0, 1.3, -2.6}, {0, 0.3, 0}, 30);
    expect_no_bias(
        gradient_bias(scene.scene, {8, 32, 128}),
        is_mirror ? GradientRow{area, "bump beside a mirror: base and offset path are mirrored far apart",
                                "a ball that mirrors under a bump map, on a floor under a normal map",
                                "each copies the half vector in the frame that its own place has; unbiased", 0.4}
                  : GradientRow{area,
                                "normal maps that turn the frame over: which normal is seen depends on where from, "
                                "and reconnected paths come from elsewhere",
                                "a floor of random normals, of which many face away from the eye",
                                "each path has the normal that its own direction sees; unbiased", 0.2, 0.06});
}

INSTANTIATE_TEST_SUITE_P(Maps, NormalMapStability, ::testing::Values("turned", "mirror"),
                         [](const auto &info) { return std::string(info.param); });

} // namespace
} // namespace gradus::testing
