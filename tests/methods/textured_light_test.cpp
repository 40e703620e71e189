// Lights with textures: whoever finds one reads its own place of it, and light sampled is the light that is found.
#include "runtime/error.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"
#include "tests/support/worse.h"

#include <cmath>
#include <numbers>

namespace gradus::testing {
namespace {

/// An emitter whose light a texture of the scene says.
std::int32_t textured_emitter(SceneMaker &maker, const Texture &texture, float factor = 1) {
    maker.scene.textures.push_back(texture);
    maker.scene.textures.back().highest = 1e30f;
    const std::int32_t number = maker.emitter(Emitter::Kind::area, {factor, factor, factor});
    maker.scene.emitters[std::size_t(number)].texture = std::int32_t(maker.scene.textures.size()) - 1;
    return number;
}

/// Half of it bright, half dark, so that a place read wrongly is seen: on a ball what lies opposite has the other
/// colour.
Texture stripes() {
    Texture texture;
    texture.kind = Texture::Kind::checkerboard;
    texture.color_0 = {4, 2, 1};
    texture.color_1 = {0.1f, 0.2f, 0.4f};
    texture.to_uv = {1, 0, 0, 0, 1, 0.25f};
    return texture;
}

/// A picture to throw, whose edges do not wrap around.
Texture picture() {
    Texture texture = random_texture(5, 4, Bitmap::Format::word, true, 9);
    texture.wrap = Texture::Wrap::clamp;
    return texture;
}

/// A spot or a projector above the floor, that looks down.
void throw_picture(SceneMaker &maker, Emitter::Kind kind) {
    maker.scene.textures.push_back(picture());
    Emitter &emitter = maker.picture(kind, {3, 3, 3}, maker.scene.textures.size() - 1, {0.2f, 1.8f, 0.1f}, 1.2f, 0.9f);
    emitter.cutoff = 0.5f;
    emitter.beam = 0.3f;
}

/// A floor and a glossy wall under a lamp and beside a ball, close to both; and a mirror, in which the lamp is seen.
SceneMaker room(std::uint64_t samples) {
    SceneMaker maker(32, samples);
    maker.look({0, 1.2, 3.6}, {0, 0.7, 0}, 40);
    maker.scene.settings.max_depth = 4;
    maker.floor(-2, 2, 2, maker.material(diffuse(0.6)));
    maker.parallelogram({-2, 0, -1.5f}, {4, 0, 0}, {0, 2.5f, 0}, maker.material(rough_metal(0.3)));
    const std::uint32_t black = maker.material(diffuse(0));
    maker.parallelogram({-0.8f, 1.5f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1.2f}, black,
                        textured_emitter(maker, random_texture(4, 3, Bitmap::Format::half, true, 3), 2));
    maker.sphere({0.9f, 0.5f, 0.2f}, 0.35f, black, textured_emitter(maker, stripes()));
    Texture of_mesh;
    of_mesh.kind = Texture::Kind::mesh_attribute;
    of_mesh.attribute = "face_glow";
    maker.parallelogram({-1.2f, 0.2f, 0}, {0, 0.6f, 0}, {0, 0, 0.6f}, black, textured_emitter(maker, of_mesh, 2));
    maker.scene.meshes.back().attributes = {{"face_glow", 1, {0.2f, 1.8f}}};
    return maker;
}

/// A lamp that bears one colour is the plain lamp of that colour: the same numbers choose the same places of it.
TEST(FullTexturedLights, OfOneColourArePlainOnes) {
    for (const std::string name : {"vertex_glow", "face_glow"}) {
        SceneMaker bears(16, 8);
        bears.look({0, 1.2, 3.6}, {0, 0.7, 0}, 40);
        bears.floor(-2, 2, 2, bears.material(diffuse(0.6)));
        SceneMaker plain = bears;
        Texture texture;
        texture.kind = Texture::Kind::mesh_attribute;
        texture.attribute = name;
        const auto add_lamp = [](SceneMaker &maker, std::int32_t emitter) {
            maker.parallelogram({-0.8f, 1.5f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1.2f}, maker.material(diffuse(0)), emitter);
        };
        add_lamp(bears, textured_emitter(bears, texture, 2));
        Mesh &mesh = bears.scene.meshes.back();
        mesh.texcoords.clear();
        const std::size_t count = name == "face_glow" ? mesh.triangles.size() : mesh.positions.size();
        mesh.attributes = {{name, 3, {}}};
        for (std::size_t i = 0; i < count; ++i)
            mesh.attributes[0].values.insert(mesh.attributes[0].values.end(), {2, 1, 0.5f});
        add_lamp(plain, plain.emitter(Emitter::Kind::area, {4, 2, 1}));
        const Image found = render(bears.scene, {}, "pt").image, expected = render(plain.scene, {}, "pt").image;
        double total = 0;
        for (const char *channel : {"R", "G", "B"})
            for (std::uint32_t y = 0; y < 16; ++y)
                for (std::uint32_t x = 0; x < 16; ++x) {
                    const double value = pixel(expected, x, y, channel);
                    total += value;
                    EXPECT_NEAR(pixel(found, x, y, channel), value, 1e-4 * value + 1e-6) << name << channel;
                }
        EXPECT_GT(total, 1);
    }
}

TEST(FullTexturedLights, AreFoundAsTheyAreSampled) {
    constexpr std::size_t seeds = 10;
    constexpr std::uint64_t samples = 64;
    const SceneMaker maker = room(samples);
    const auto images = [&](RenderOptions::Strategy strategy, std::uint64_t first) {
        RenderOptions options;
        options.strategy = strategy;
        return render_seeds(maker.scene, seeds, options, first);
    };
    const std::vector<Image> light = images(RenderOptions::Strategy::light, 1);
    const std::vector<Image> bsdf = images(RenderOptions::Strategy::bsdf, 100);
    EXPECT_TRUE(agree("textured-lights", light, bsdf, double(samples)));
    // Other lights of the same power would be told apart.
    SceneMaker even = maker;
    for (Emitter &emitter : even.scene.emitters) {
        const auto mean = texture_range(even.scene.textures[std::size_t(emitter.texture)]).mean;
        emitter.value = {float(emitter.value.r * mean[0]), float(emitter.value.g * mean[1]),
                         float(emitter.value.b * mean[2])};
        emitter.texture = no_texture;
    }
    RenderOptions options;
    options.strategy = RenderOptions::Strategy::light;
    EXPECT_FALSE(agree("even-lights", light, render_seeds(even.scene, seeds, options, 200), double(samples)));
}

/// Light paths begin with the colour of their place: what photons show is what paths do, lights and pictures alike.
TEST(FullTexturedLights, SendPhotonsOfTheirColours) {
    SceneMaker maker = room(64);
    throw_picture(maker, Emitter::Kind::projector);
    throw_picture(maker, Emitter::Kind::spot);
    maker.scene.emitters.back().position = {-0.9f, 1.4f, 0.6f};
    maker.scene.settings.max_depth = 2; // what lights send directly, which photons alone make here
    RenderOptions options;
    options.direct_photons = true;
    options.photons = 400'000;
    const Image paths = mean_image(render_seeds(maker.scene, 4, {}, 1, "pt"));
    const Image photons = mean_image(render_seeds(maker.scene, 2, options, 1, "sppm"));
    Image moved = render(maker.scene, options, "gpm").image; // which moves them, and has no stage `material`
    for (const char *channel : {"R", "G", "B"}) {
        const Spread expected = spread_of(paths, channel), found = spread_of(photons, channel);
        const double by_gpm = spread_of(moved, channel).mean;
        std::printf("%s: paths %.4f, photons %.4f, moved %.4f\n", channel, expected.mean, found.mean, by_gpm);
        // Some 0.2 % of noise each, and what borders lose within the radius, as in PathKinds.
        EXPECT_NEAR(found.mean / expected.mean, 1, 0.025) << channel;
        EXPECT_NEAR(by_gpm / expected.mean, 1, 0.025) << channel;
    }
    // The colours are where they belong: over blocks, the floor's part of the image.
    double worst = 0;
    for (std::uint32_t by = 20; by < 32; by += 4)
        for (std::uint32_t bx = 4; bx < 28; bx += 4) {
            double expected = 0, found = 0;
            for (std::uint32_t y = by; y < by + 4; ++y)
                for (std::uint32_t x = bx; x < bx + 4; ++x) {
                    expected += pixel(paths, x, y, "R") / pixel(paths, x, y, "B");
                    found += pixel(photons, x, y, "R") / pixel(photons, x, y, "B");
                }
            worst = worse(worst, std::fabs(found / expected - 1));
        }
    std::printf("colour of blocks: off by %.3f at most\n", worst);
    EXPECT_LT(worst, 0.1);
}

/// What a camera sees of a lamp is its texture, at the place that all pixels of a sample share.
TEST(FullTexturedLights, AreSeenAsTheyAre) {
    SceneMaker maker(24, 16);
    maker.look({0, 0, 3}, {0, 0, 0}, 40);
    const Texture texture = random_texture(3, 2, Bitmap::Format::real, true, 5);
    maker.parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(diffuse(0)),
                        textured_emitter(maker, texture, 3));
    maker.scene.settings.max_depth = 2;
    const Image expected = mean_image(render_seeds(maker.scene, 8, {}, 1, "pt"));
    const Image gradient = render(maker.scene, {}, "gpt").image;
    double contrast = 0;
    for (const char *channel : {"R", "G", "B"})
        for (std::uint32_t i = 0; i < 24; ++i) {
            // Within a pixel the texture changes by less than a twentieth, of which places of two sorts see the mean.
            EXPECT_NEAR(pixel(gradient, i, 9, channel), pixel(expected, i, 9, channel), 0.05) << i;
            contrast = std::max(contrast, std::fabs(pixel(expected, i, 9, channel) - pixel(expected, 0, 9, channel)));
        }
    EXPECT_GT(contrast, 0.3);
}

/// A wall that a projector lights head on has the picture's colours, from wherever they are seen, by paths and by
/// photons alone.
TEST(Projector, PaintsAWallWithItsPicture) {
    constexpr std::uint32_t size = 16;
    SceneMaker maker(size, 256);
    maker.look({0, 0, 4}, {0, 0, 0}, 20); // sees less than the picture
    maker.scene.settings.max_depth = 2;
    maker.parallelogram({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, maker.material(diffuse(1)));
    maker.scene.textures.push_back(picture());
    Emitter emitter;
    emitter.kind = Emitter::Kind::projector;
    emitter.value = {float(std::numbers::pi), float(std::numbers::pi), float(std::numbers::pi)};
    emitter.texture = 0;
    emitter.position = {0, 0, 1};
    emitter.axes = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    emitter.direction = {0, 0, -1};
    emitter.picture = {2, 1.6f};
    maker.scene.emitters.push_back(emitter);
    RenderOptions options;
    options.reconstruction = Reconstruction::l2;
    const Image image = render(maker.scene, options, "gpt").image;
    const double half = 4 * std::tan(10 * std::numbers::pi / 180);
    double mean = 0;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            double expected = 0;
            for (int i = 0; i < 64; ++i) {
                const double across = half * (2 * (x + (i % 8 + 0.5) / 8) / size - 1);
                const double down = half * (2 * (y + (i / 8 + 0.5) / 8) / size - 1);
                expected += texture_value(maker.scene.textures[0], 0.5 + across / 2, 0.5 + down / 1.6)[1] / 64;
            }
            // A texel is 4.5 pixels wide: values within a pixel differ by a quarter, with 256 samples a sixteenth.
            EXPECT_NEAR(pixel(image, x, y), expected, 5 * 0.25 / 16 / std::sqrt(12.0)) << x << ", " << y;
            mean += expected / (size * size);
        }
    // Some 60,000 photons are seen in all, and discs of a pixel's radius reach over the image's border.
    maker.scene.settings.samples_per_pixel = 4;
    options.direct_photons = true;
    options.photons = 25'000;
    EXPECT_NEAR(spread_of(render(maker.scene, options, "sppm").image, "G").mean, mean, 0.03 * mean);
}

/// Nothing leaves a projector beside its picture or behind it.
TEST(FullProjector, IsDarkBesideItsPicture) {
    SceneMaker maker(16, 16);
    maker.look({0, 0, 4}, {0, 0, 0}, 60);
    maker.scene.settings.max_depth = 2;
    maker.parallelogram({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, maker.material(diffuse(1)));
    Emitter emitter;
    emitter.kind = Emitter::Kind::projector;
    emitter.value = {1, 1, 1};
    emitter.position = {0, 0, 1};
    emitter.axes = {{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}};
    emitter.direction = {0, 0, -1};
    emitter.picture = {2, 1};
    maker.scene.emitters.push_back(emitter);
    const Image image = render(maker.scene).image;
    const double half = 4 * std::tan(30 * std::numbers::pi / 180);
    double lit = 0;
    for (std::uint32_t y = 0; y < 16; ++y)
        for (std::uint32_t x = 0; x < 16; ++x) {
            const double left = half * (x / 8.0 - 1), top = half * (y / 8.0 - 1), wide = half / 8;
            lit += pixel(image, x, y) * wide * wide;
            const bool is_outside = left > 1 || left + wide < -1 || top > 0.5 || top + wide < -0.5;
            if (is_outside) {
                EXPECT_EQ(pixel(image, x, y), 0) << x << ", " << y;
            }
        }
    // An irradiance of 1 on 2 by 1: the wall's radiance times its area is 2 over pi.
    EXPECT_NEAR(lit, 2 / std::numbers::pi, 0.02);
    maker.scene.emitters[0].position = {0, 0, -1};
    EXPECT_EQ(spread_of(render(maker.scene).image).most, 0);
}

} // namespace
} // namespace gradus::testing
