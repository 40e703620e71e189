// Textures in the renderer: exact values where the light is the same from everywhere.
#include "runtime/error.h"
#include "runtime/scene/camera_record.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"
#include "tests/support/textures.h"
#include "tests/support/worse.h"

#include <array>
#include <functional>
#include <numbers>

#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/random.h"
#include "kernels/shared/scene_records.h"

namespace gradus::testing {
namespace {

constexpr std::uint32_t size = 24;
/// A sample's value goes through some ten roundings by 2^-24, and (u, v) through as many, by which a texture of eight
/// texels changes eight times as fast: values and differences of two.
constexpr double rounding = 2 * 10 * 9 * 0x1p-24;

Color textured(SceneMaker &maker, const Texture &texture) {
    maker.scene.textures.push_back(texture);
    Color color(0.5f, 0.5f, 0.5f);
    color.texture = std::int32_t(maker.scene.textures.size()) - 1;
    return color;
}

Bsdf textured_diffuse(SceneMaker &maker, const Texture &texture) {
    Bsdf bsdf;
    bsdf.reflectance = textured(maker, texture);
    return bsdf;
}

/// A wall [-2, 2]^2 at z = 0 that a camera at z = 3 sees and nothing else, under light of radiance 1 from everywhere:
/// each sample is worth the wall's reflectance.
SceneMaker wall(const Texture &texture) {
    SceneMaker maker(size, 1);
    maker.look({0, 0, 3}, {0, 0, 0}, 40);
    maker.environment(1);
    maker.parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(textured_diffuse(maker, texture)));
    return maker;
}

/// (u, v) of the wall at a place of the film, in pixels.
std::array<double, 2> wall_at(const Scene &scene, double film_x, double film_y) {
    using namespace lib_float;
    const std::vector<float> camera = make_camera_record(scene.camera, scene.film);
    std::array<double, 3> direction, hit;
    for (int axis = 0; axis < 3; ++axis)
        direction[axis] = camera[std::size_t(camera_corner_x + axis)] +
                          film_x * camera[std::size_t(camera_right_x + axis)] +
                          film_y * camera[std::size_t(camera_down_x + axis)];
    for (int axis = 0; axis < 3; ++axis)
        hit[axis] =
            camera[std::size_t(camera_origin_x + axis)] - direction[axis] * camera[camera_origin_z] / direction[2];
    return {(hit[0] + 2) / 4, (hit[1] + 2) / 4};
}

/// The same where a pixel looks, at the place that all pixels of sample 0 of a seed share.
std::array<double, 2> seen_place(const Scene &scene, std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
    using namespace lib_float;
    const random_bits start = random_key(seed, 0, 0xFFFFFFFFu, 0, 0);
    const point2 place = additive_sequence(start.x, start.y, 0);
    return wall_at(scene, x + double(place.x), y + double(place.y));
}

RenderOptions exact_options() {
    RenderOptions options;
    options.strategy = SessionOptions::Strategy::bsdf;
    options.reconstruction = Reconstruction::l2;
    options.seed = 7;
    return options;
}

/// Checks an image's layers against what each pixel is to be worth.
void expect_layers(const Image &image, const std::function<double(int c, std::uint32_t x, std::uint32_t y)> &expected) {
    double contrast = 0;
    for (int c = 0; c < 3; ++c)
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x) {
                const double value = expected(c, x, y);
                ASSERT_NEAR(layer(image, "primal", c, x, y), value, rounding) << x << ", " << y;
                ASSERT_NEAR(image.find(colors[c])->values[y * size + x], value, 4 * rounding) << x << ", " << y;
                if (x + 1 < size) {
                    const double difference = expected(c, x + 1, y) - value;
                    ASSERT_NEAR(layer(image, "dx", c, x, y), difference, rounding) << x << ", " << y;
                    contrast = std::max(contrast, std::fabs(difference));
                }
                if (y + 1 < size) {
                    ASSERT_NEAR(layer(image, "dy", c, x, y), expected(c, x, y + 1) - value, rounding) << x << ", " << y;
                }
            }
    EXPECT_GT(contrast, 0.01);
}

TEST(Textures, DifferencesOfAWallAreThoseOfItsTexture) {
    const Texture texture = random_texture();
    const SceneMaker maker = wall(texture);
    RenderOptions options = exact_options();
    options.aov = true;
    const Image image = render(maker.scene, options, "gpt").image;
    const auto expected = [&](int c, std::uint32_t x, std::uint32_t y) {
        const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
        return texture_value(texture, u, v)[std::size_t(c)];
    };
    expect_layers(image, expected);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(layer(image, "albedo", c, 5, 9), expected(c, 5, 9), rounding);
}

/// What is seen by way of a mirror: offset paths have vertices of their own on the mirror and on the wall.
TEST(Textures, DifferencesInATexturedMirrorAreThoseOfBothTextures) {
    SceneMaker maker(size, 1);
    maker.look({0, 0, 3}, {0, 0, 0}, 40);
    // Slanting past the mirror onto the wall, where it makes a radiance of the reflectance.
    const auto irradiance = float(std::numbers::pi * std::sqrt(101.0));
    const auto length = float(std::sqrt(101.0));
    maker.directional_light({irradiance, irradiance, irradiance}, {-10 / length, 0, 1 / length});
    maker.scene.settings.max_depth = 3;
    Bsdf mirror;
    mirror.kind = BsdfKind::conductor;
    mirror.specular_reflectance = textured(maker, random_texture(5, 7, Bitmap::Format::word, true, 3));
    maker.parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(mirror));
    // Behind the camera, its front towards the mirror.
    maker.parallelogram({8, -8, 4}, {-16, 0, 0}, {0, 16, 0},
                        maker.material(textured_diffuse(maker, random_texture(6, 8, Bitmap::Format::half, true, 4))));
    RenderOptions options = exact_options();
    options.strategy = SessionOptions::Strategy::mis;
    const Image image = render(maker.scene, options, "gpt").image;
    expect_layers(image, [&](int c, std::uint32_t x, std::uint32_t y) {
        const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
        // From z = 3 to 0 the ray has gone as far aside as to (u, v); back to 4, 4 / 3 times as far again.
        const double across = (4 * u - 2) * (1 + 4.0 / 3), up = (4 * v - 2) * (1 + 4.0 / 3);
        return texture_value(maker.scene.textures[0], u, v)[std::size_t(c)] *
               texture_value(maker.scene.textures[1], (8 - across) / 16, (up + 8) / 16)[std::size_t(c)];
    });
}

/// The wall with a mesh attribute, its triangles not the first of the scene.
SceneMaker wall_with_attribute(const MeshAttribute &attribute) {
    Texture texture;
    texture.kind = Texture::Kind::mesh_attribute;
    texture.attribute = attribute.name;
    texture.scale = {0.75f, 1, 1};
    SceneMaker maker = wall(texture);
    maker.parallelogram({50, 50, 50}, {1, 0, 0}, {0, 1, 0}, maker.material(diffuse(0.5)));
    std::swap(maker.scene.shapes[0], maker.scene.shapes[1]);
    maker.scene.meshes[0].attributes = {attribute};
    return maker;
}

/// Numbers at the corners of a wall are interpolated.
TEST(Textures, VertexAttributesAreInterpolated) {
    // At the corners as SceneMaker::parallelogram has them.
    const SceneMaker maker = wall_with_attribute(
        {"vertex_color", 3, {0.1f, 0.8f, 0.4f, 0.9f, 0.8f, 0.4f, 0.9f, 0.3f, 0.8f, 0.1f, 0.3f, 0.8f}});
    const RenderOptions options = exact_options();
    expect_layers(render(maker.scene, options, "gpt").image, [&](int c, std::uint32_t x, std::uint32_t y) {
        const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
        const double value[] = {0.75 * (0.1 + 0.8 * u), 0.8 - 0.5 * v, 0.4 + 0.4 * v};
        return value[c];
    });
}

/// One number for each triangle, which is gray.
TEST(Textures, FaceAttributesAreConstantOnATriangle) {
    const SceneMaker maker = wall_with_attribute({"face_shade", 1, {0.2f, 0.7f}});
    const RenderOptions options = exact_options();
    const auto &triangle = maker.scene.meshes[0].triangles[0];
    const bool first_is_below = triangle[0] + triangle[1] + triangle[2] == 3; // corners 0, 1, 2: where u > v
    ASSERT_TRUE(first_is_below);
    expect_layers(render(maker.scene, options, "gpt").image, [&](int c, std::uint32_t x, std::uint32_t y) {
        const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
        return (u > v ? 0.2 : 0.7) * (c == 0 ? 0.75 : 1);
    });
}

/// A mesh with (u, v), one without, and one with numbers at its vertices, by shared vertices and by records of their
/// own: each value is the same but for how kernels join multiplications and additions.
TEST(Textures, AreReadByIndexAlike) {
    SceneMaker maker = wall_with_attribute(
        {"vertex_color", 3, {0.1f, 0.8f, 0.4f, 0.9f, 0.8f, 0.4f, 0.9f, 0.3f, 0.8f, 0.1f, 0.3f, 0.8f}});
    const std::uint32_t textured_again = maker.material(textured_diffuse(maker, random_texture()));
    maker.parallelogram({-1.5f, -1.5f, 0.25f}, {1.25f, 0, 0}, {0, 1.25f, 0.25f}, textured_again);
    maker.parallelogram({0.25f, 0.25f, 0.25f}, {1, 0, 0}, {0, 1, 0.25f}, textured_again);
    maker.scene.meshes.back().texcoords.clear();
    maker.scene.meshes.back().normals.assign(4, {0, -0.6f, 0.8f});
    Bsdf brushed = rough_metal(0.1);
    brushed.alpha_v = 0.5f;
    brushed.specular_reflectance = textured(maker, random_texture());
    for (const bool has_texcoords : {false, true}) {
        maker.parallelogram({-1, has_texcoords ? 0 : 0.9f, 0.25f}, {0.8f, 0, 0}, {0, 0.8f, 0.25f},
                            maker.material(brushed));
        if (!has_texcoords)
            maker.scene.meshes.back().texcoords.clear();
    }
    RenderOptions options = exact_options();
    options.aov = true;
    const Image by_record = render(maker.scene, options).image;
    options.by_index = true;
    const Image by_index = render(maker.scene, options).image;
    for (const Channel &channel : by_record.channels)
        for (std::size_t i = 0; i < channel.values.size(); ++i)
            ASSERT_NEAR(by_index.find(channel.name)->values[i], channel.values[i], rounding * 4)
                << channel.name << " " << i;
}

/// Two sides of two textures, and a third material without one, whose record lies between them.
TEST(Textures, SidesHaveTheirOwn) {
    for (const bool from_behind : {false, true}) {
        SceneMaker maker = wall(random_texture());
        Material &material = maker.scene.materials[0];
        material.two_sided = true;
        material.back = textured_diffuse(maker, random_texture(5, 3, Bitmap::Format::real, false, 2));
        const std::uint32_t other = maker.material(diffuse(0.5));
        maker.parallelogram({50, 50, 50}, {1, 0, 0}, {0, 1, 0}, other);
        if (from_behind)
            maker.look({0, 0, -3}, {0, 0, 0}, 40);
        const RenderOptions options = exact_options();
        const Image image = render(maker.scene, options, "gpt").image;
        expect_layers(image, [&](int c, std::uint32_t x, std::uint32_t y) {
            const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
            return texture_value(maker.scene.textures[from_behind ? 1 : 0], u, v)[std::size_t(c)];
        });
    }
}

/// A wall of a textured colour, and `pictures` of four numbers by pictures of one texel, the others as constants; with
/// `others` textures that nothing has.
Image lit_wall(int pictures, int others) {
    SceneMaker maker(size, 1);
    maker.look({0, 0, 3}, {0, 0, 0}, 40);
    maker.directional_light({3, 3, 3}, {0.6f, 0, -0.8f});
    maker.scene.settings.max_depth = 2;
    Bsdf bsdf;
    bsdf.kind = BsdfKind::principled;
    Number *const numbers[] = {&bsdf.metallic, &bsdf.sheen, &bsdf.flatness, &bsdf.clearcoat};
    for (int i = 0; i < 4; ++i) {
        const std::uint32_t code = 40 + 50 * std::uint32_t(i);
        numbers[i]->value = float(code) / 255;
        if (i >= pictures)
            continue;
        auto bitmap = std::make_shared<Bitmap>();
        bitmap->resize(1, 1, Bitmap::Format::byte, false);
        bitmap->set(0, 0, 0, code);
        Texture texture;
        texture.bitmap = bitmap;
        numbers[i]->texture = std::int32_t(maker.scene.textures.size());
        maker.scene.textures.push_back(texture);
    }
    Texture mapped = random_texture();
    mapped.to_uv = {2, 0, 0.25f, 0, 3, 0};
    bsdf.reflectance = textured(maker, mapped);
    maker.scene.textures.resize(maker.scene.textures.size() + std::size_t(others), random_texture());
    maker.parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(bsdf));
    return render(maker.scene, RenderOptions(), "pt").image;
}

/// However many a material has, which decides how kernels look them up, and the scene, which decides how they are read.
TEST(Textures, SeveralOfAMaterialAreEachInTheirPlace) {
    const Image constants = lit_wall(0, 0);
    for (const auto &[pictures, others] : {std::pair{1, 0}, {2, 9}, {4, 0}}) {
        const Image image = lit_wall(pictures, others);
        double largest = 0;
        for (int c = 0; c < 3; ++c)
            for (std::uint32_t y = 0; y < size; ++y)
                for (std::uint32_t x = 0; x < size; ++x) {
                    const double expected = constants.find(colors[c])->values[y * size + x];
                    ASSERT_NEAR(image.find(colors[c])->values[y * size + x], expected, rounding)
                        << pictures << " pictures, " << others << " others, at " << x << ", " << y;
                    largest = worse(largest, expected);
                }
        EXPECT_GT(largest, 0.1);
    }
}

/// Strips of a wall and a sphere before it, each of another class: bytes of gray, halves in colour, no texture, a rough
/// metal, a blend whose weight is a texture, and two sides. `pictures`: of one texel, in place of constants.
void add_wall_of_classes(SceneMaker &maker, bool pictures, float x) {
    Scene &scene = maker.scene;
    const auto picture_of = [&](Bitmap::Format format, bool is_color, std::array<std::uint32_t, 3> code) {
        auto bitmap = std::make_shared<Bitmap>();
        bitmap->resize(1, 1, format, is_color);
        for (std::uint32_t c = 0; c < (is_color ? 3u : 1u); ++c)
            bitmap->set(0, 0, c, code[c]);
        Texture texture;
        texture.bitmap = bitmap;
        scene.textures.push_back(texture);
        return pictures ? std::int32_t(scene.textures.size() - 1) : no_texture;
    };
    const auto gray = [&](std::uint32_t code) {
        Bsdf bsdf = diffuse(float(code) / 255);
        bsdf.reflectance.texture = picture_of(Bitmap::Format::byte, false, {code});
        return bsdf;
    };
    Bsdf colored = diffuse(0.5);
    colored.reflectance = {0.5f, 0.25f, 0.75f};
    colored.reflectance.texture = picture_of(Bitmap::Format::half, true, {0x3800, 0x3400, 0x3A00});
    Bsdf metal = diffuse(0.5);
    metal.kind = BsdfKind::roughconductor_ggx;
    metal.alpha_u = metal.alpha_v = Number(102.0f / 255);
    metal.alpha_u.texture = metal.alpha_v.texture = picture_of(Bitmap::Format::byte, false, {102});
    const auto part = std::uint32_t(scene.blended.size());
    scene.blended.insert(scene.blended.end(), {gray(51), metal});
    scene.blends.push_back({part, part + 1, 51.0f / 255});
    scene.blends.back().weight.texture = picture_of(Bitmap::Format::byte, false, {51});
    Bsdf blend;
    blend.blend = std::int32_t(scene.blends.size() - 1);
    float left = x - 2;
    for (const Bsdf &bsdf : {gray(204), colored, diffuse(0.3f), metal, blend, gray(26)}) {
        maker.parallelogram({left, -2, 0}, {0.6f, 0, 0}, {0, 4, 0}, maker.material(bsdf));
        left += 0.6f;
    }
    const std::uint32_t sides = maker.material(metal);
    scene.materials[sides].two_sided = true;
    scene.materials[sides].back = colored;
    maker.sphere({x, -0.5f, 1}, 0.3f, sides);
    maker.parallelogram({x - 0.3f, 0.4f, 0.5f}, {0, 0.6f, 0}, {0.6f, 0, 0}, sides); // from behind
}

/// Rough plastics of a wall: two whose roughness is a picture share a kind and an index, one has others, and of one
/// only the base is a picture. `pictures`: of one texel, in place of constants.
void add_wall_of_coats(SceneMaker &maker, bool pictures, float x) {
    const auto picture_of = [&](std::uint32_t code) {
        auto bitmap = std::make_shared<Bitmap>();
        bitmap->resize(1, 1, Bitmap::Format::byte, false);
        bitmap->set(0, 0, 0, code);
        Texture texture;
        texture.bitmap = bitmap;
        maker.scene.textures.push_back(texture);
        return pictures ? std::int32_t(maker.scene.textures.size() - 1) : no_texture;
    };
    float left = x - 2;
    const auto add = [&](Bsdf bsdf) {
        set_coating(bsdf);
        maker.parallelogram({left, -2, 0}, {1, 0, 0}, {0, 4, 0}, maker.material(bsdf));
        left += 1;
    };
    const auto coat = [&](BsdfKind kind, std::uint32_t code, float ior) {
        Bsdf bsdf = diffuse(0.6);
        bsdf.kind = kind;
        bsdf.ior = ior;
        bsdf.nonlinear = 1.0f;
        bsdf.alpha_u = bsdf.alpha_v = Number(float(code) / 255);
        return bsdf;
    };
    const auto varying = [&](BsdfKind kind, std::uint32_t code, float ior) {
        Bsdf bsdf = coat(kind, code, ior);
        bsdf.alpha_u.texture = bsdf.alpha_v.texture = picture_of(code);
        if (pictures)
            bsdf.alpha_u.value = bsdf.alpha_v.value = 0.02f; // as if it were as smooth as that elsewhere
        return bsdf;
    };
    add(varying(BsdfKind::roughplastic_ggx, 38, 1.5f));
    Bsdf base_alone = coat(BsdfKind::roughplastic_ggx, 77, 1.5f);
    base_alone.reflectance = {0.2f, 0.2f, 0.2f};
    base_alone.reflectance.texture = picture_of(51);
    add(base_alone);
    add(varying(BsdfKind::roughplastic_ggx, 153, 1.5f));
    add(varying(BsdfKind::roughplastic_beckmann, 102, 1.9f));
}

using AddWall = void(SceneMaker &maker, bool pictures, float x);

/// A wall of pictures or of constants; the other one is out of sight, so that both images are those of the same
/// kernels.
Image image_of_wall(AddWall *add, bool pictures, const char *method) {
    SceneMaker maker(size, 1);
    maker.look({0, 0, 3}, {0, 0, 0}, 60);
    maker.directional_light({3, 3, 3}, {0.6f, 0, -0.8f});
    maker.scene.settings.max_depth = 2;
    maker.scene.textures.push_back(random_texture()); // nobody's
    add(maker, pictures, 0);
    add(maker, !pictures, 50);
    return render(maker.scene, RenderOptions(), method).image;
}

class TexturesOfClasses : public ::testing::TestWithParam<const char *> {};

/// In pt those that shade, in sppm those of the stage `material`.
TEST_P(TexturesOfClasses, KernelsReadThoseOfTheirClass) {
    const Image constants = image_of_wall(add_wall_of_classes, false, GetParam()),
                read = image_of_wall(add_wall_of_classes, true, GetParam());
    double largest = 0;
    for (int c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < size * size; ++i) {
            const double expected = constants.find(colors[c])->values[i];
            ASSERT_NEAR(read.find(colors[c])->values[i], expected, rounding * (1 + expected))
                << colors[c] << " of pixel " << i;
            largest = worse(largest, expected);
        }
    EXPECT_GT(largest, 0.5);
}
INSTANTIATE_TEST_SUITE_P(Methods, TexturesOfClasses, ::testing::Values("pt"), name_of_method);
INSTANTIATE_TEST_SUITE_P(Full, TexturesOfClasses, ::testing::Values("sppm"), name_of_method);

class TexturesOfCoats : public ::testing::TestWithParam<const char *> {};

/// What a coat lets pass is known of some roughnesses, and linear between: as near as the polynomials that it is made
/// of.
TEST_P(TexturesOfCoats, VaryWhatACoatLetsPass) {
    constexpr double between = 2e-3;
    const Image constants = image_of_wall(add_wall_of_coats, false, GetParam()),
                read = image_of_wall(add_wall_of_coats, true, GetParam());
    double largest = 0;
    for (std::size_t i = 0; i < size * size; ++i) {
        const double expected = constants.find("R")->values[i];
        ASSERT_NEAR(read.find("R")->values[i], expected, between * expected) << "pixel " << i;
        largest = worse(largest, expected);
    }
    EXPECT_GT(largest, 0.3);
}
INSTANTIATE_TEST_SUITE_P(Methods, TexturesOfCoats, ::testing::Values("pt"), name_of_method);
INSTANTIATE_TEST_SUITE_P(Full, TexturesOfCoats, ::testing::Values("gpt"), name_of_method);

class BlendsBy : public ::testing::TestWithParam<const char *> {};

/// A sphere of half mirror, half wall, under light from everywhere, has the radiance of its mean albedo, however the
/// parts are nested, and from both sides. (Mitsuba 3.9 is no judge of it: it weighs a Dirac part by densities.)
TEST_P(BlendsBy, HaveTheMeanOfTheirParts) {
    const std::string method = GetParam();
    SceneMaker maker(16, 256);
    maker.look({0, 0, 4}, {0, 0, 0}, 24);
    maker.environment(1);
    maker.scene.settings.max_depth = 3;
    Bsdf mirror, black = diffuse(0);
    mirror.kind = BsdfKind::conductor;
    Scene &scene = maker.scene;
    // 0.25 of a mirror of 1, and of the rest 0.6 of a wall of 0.8 beside a black one: 0.25 + 0.75 * 0.6 * 0.8.
    scene.blended = {black, diffuse(0.8), Bsdf(), mirror};
    scene.blends = {{0, 1, 0.6f}, {2, 3, 0.25f}};
    scene.blended[2].blend = 0;
    Bsdf both;
    both.blend = 1;
    constexpr double expected = 0.25 + 0.75 * 0.6 * 0.8;
    for (const bool from_behind : {false, true}) {
        SceneMaker turned = maker;
        turned.sphere({0, 0, 0}, 1, turned.material(two_sided(both, both)), -1, from_behind);
        RenderOptions options;
        options.reconstruction = Reconstruction::l2;
        options.photons = 10'000;
        const Image image = render(turned.scene, options, method.c_str()).image;
        double mean = 0;
        for (std::uint32_t y = 4; y < 12; ++y)
            for (std::uint32_t x = 4; x < 12; ++x)
                mean += pixel(image, x, y) / 64;
        // A sample of pt is 1, 0.8 or 0: a deviation of 0.45 over the root of 16384. Of gpt all pixels choose alike: an
        // even sequence of 256 numbers is off by some 2 in 256.
        EXPECT_NEAR(mean, expected, method == "gpt" ? 3.0 / 256 : 5 * 0.45 / 128);
    }
}
INSTANTIATE_TEST_SUITE_P(Methods, BlendsBy, ::testing::Values("pt", "gpt"), name_of_method);
INSTANTIATE_TEST_SUITE_P(Full, BlendsBy, ::testing::Values("sppm"), name_of_method);

/// Where the weight is a texture, the value at a place is that of both parts in its proportion.
TEST(Blends, TakeTheirWeightFromATexture) {
    Texture weight = random_texture(4, 3, Bitmap::Format::word, false);
    SceneMaker maker = wall(weight);
    Scene &scene = maker.scene;
    scene.settings.samples_per_pixel = 4096;
    scene.film.width = scene.film.height = 4;
    scene.blended = {diffuse(0.2), diffuse(0.9)};
    scene.blends = {{0, 1, 0.5f}};
    scene.blends[0].weight.texture = 0;
    scene.materials[0] = Material();
    scene.materials[0].front.blend = 0;
    for (const char *method : {"pt", "gpt"}) {
        RenderOptions options = exact_options();
        const Image image = render(scene, options, method).image;
        for (std::uint32_t y = 0; y < 4; ++y)
            for (std::uint32_t x = 0; x < 4; ++x) {
                double expected = 0;
                constexpr int parts = 32;
                for (int i = 0; i < parts * parts; ++i) {
                    const auto [u, v] = wall_at(scene, x + (i % parts + 0.5) / parts, y + (i / parts + 0.5) / parts);
                    expected += (0.2 + 0.7 * texture_value(weight, u, v)[0]) / (parts * parts);
                }
                EXPECT_NEAR(pixel(image, x, y), expected, 5 * 0.35 / 64) << method << " " << x << ", " << y;
            }
    }
}

/// For scenes of 16 x 16 pixels and 64 samples that differ by their textures.
void expect_photons_see_what_paths_see(const Scene &scene) {
    RenderOptions options;
    const Spread paths = spread_of(render(scene, options, "pt").image);
    const Spread photons = spread_of(render(scene, options, "sppm").image);
    std::printf("mean by paths %.5f, by photons %.5f\n", paths.mean, photons.mean);
    // 16 x 16 x 64 samples, each with a relative deviation of about 1.5: half a percent each; and the photons' bias.
    EXPECT_NEAR(photons.mean / paths.mean, 1, 0.03);
}

/// Gathered photons are scattered by the texture of the gather point, and by those that they met before.
TEST(Textures, PhotonsMeetThem) {
    SceneMaker maker(16, 64);
    maker.look({0, 0, 0.95}, {0, 0, 0}, 90);
    maker.cube(maker.material(textured_diffuse(maker, random_texture())), -1, true);
    maker.lamp({0, 0.9f, 0}, 0.5f, 0.5f, 5, maker.material(diffuse(0)));
    maker.scene.settings.max_depth = 4;
    expect_photons_see_what_paths_see(maker.scene);
}

NormalTexture map_of(Scene &scene, const Texture &texture, NormalTexture::Kind kind) {
    NormalTexture map;
    map.kind = kind;
    map.texture = std::int32_t(scene.textures.size());
    scene.textures.push_back(texture);
    scene.textures.back().lowest = -1e30f;
    scene.textures.back().highest = 1e30f;
    return map;
}

/// A card under a map that leans towards the floor behind it. Who looks at a two-sided card from there sees its other
/// side; a card with one side sends light past its own horizon, and paths find it there, too.
TEST(Textures, PhotonsDoNotPassTwoSidedCardsUnderNormalMaps) {
    for (const bool both : {true, false}) {
        SceneMaker maker(16, 64);
        maker.look({-2, 2, 0}, {-1, 0, 0}, 50, {0, 0, 1});
        Texture leaning;
        leaning.kind = Texture::Kind::checkerboard;
        leaning.color_0 = leaning.color_1 = {0.9f, 0.5f, 0.8f};
        Bsdf card = diffuse(0.9);
        card.map = map_of(maker.scene, leaning, NormalTexture::Kind::normal);
        maker.parallelogram({0, 2, 1}, {0, -2, 0}, {0, 0, -2},
                            maker.material(both ? two_sided(card, card) : material_of(card)));
        maker.floor(-2, 0, 2, maker.material(diffuse(0.5)));
        maker.point_light({5, 5, 5}, {1, 1, 0});
        maker.point_light({0.5f, 0.5f, 0.5f}, {-1, 1, 0});
        maker.scene.settings.max_depth = 3;
        expect_photons_see_what_paths_see(maker.scene);
    }
}

/// Their kernels take longer to compile than ./check can afford; tests/scene has what maps make of normals.
class NormalMaps : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Full, NormalMaps, ::testing::Values(0));

double dot(const std::array<double, 3> &a, const std::array<double, 3> &b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

std::array<double, 3> normalised(const std::array<double, 3> &a) {
    const double length = std::sqrt(dot(a, a));
    return {a[0] / length, a[1] / length, a[2] / length};
}

/// What a white wall under a map is worth in light from one direction, with the irradiance pi across that: front is its
/// own normal, mapped the map's, both towards the camera where flags do not turn the latter.
double expected_of(const NormalTexture &map, const std::array<double, 3> &front, std::array<double, 3> mapped,
                   const std::array<double, 3> &wi, const std::array<double, 3> &light) {
    if (map.turns_over && dot(wi, front) * dot(wi, mapped) <= 0)
        for (std::size_t i = 0; i < 3; ++i)
            mapped[i] = 2 * dot(front, mapped) * front[i] - mapped[i];
    const double cosine = dot(mapped, light), own = dot(front, light), tilt = dot(front, mapped);
    if (dot(mapped, wi) <= 0 || cosine <= 0 || own <= 0)
        return 0;
    const double roughness = std::min(0.125 * (1 / (tilt * tilt) - 1), 1.0);
    return cosine * (map.shadows ? 2 / (1 + std::sqrt(1 + roughness * (1 / (own * own) - 1))) : 1);
}

/// Shading and its differences over a wall of normals, from the front and through `twosided` from behind.
TEST_P(NormalMaps, DifferencesOfAWallAreThoseOfItsNormals) {
    for (const int flags : {0, 1, 2, 3})
        for (const int side : {0, 1, 2}) { // the front; the back of `twosided` around the map; and within it
            Texture texture = random_texture(5, 4, Bitmap::Format::real, true, 5);
            texture.scale = {1, 1, 1.5f};
            SceneMaker maker(size, 1);
            const double z = side == 0 ? 3 : -3;
            maker.look({0, 0, z}, {0, 0, 0}, 40);
            const std::array<double, 3> towards = normalised({0.6, 0.3, side == 0 ? 0.7 : -0.7});
            const auto irradiance = float(std::numbers::pi);
            maker.directional_light({irradiance, irradiance, irradiance},
                                    {-float(towards[0]), -float(towards[1]), -float(towards[2])});
            maker.scene.settings.max_depth = 2;
            Bsdf white = diffuse(1);
            white.map = map_of(maker.scene, texture, NormalTexture::Kind::normal);
            white.map.turns_over = (flags & 1) != 0;
            white.map.shadows = (flags & 2) != 0;
            white.map.is_outside = side == 2;
            maker.parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.material(two_sided(white, white)));
            RenderOptions options = exact_options();
            options.strategy = SessionOptions::Strategy::mis;
            const Image image = render(maker.scene, options, "gpt").image;
            std::size_t turned = 0, close = 0;
            const auto expected = [&](std::uint32_t x, std::uint32_t y, bool &is_close) {
                const auto [u, v] = seen_place(maker.scene, x, y, std::uint32_t(options.seed));
                const std::array<double, 3> color = texture_value(maker.scene.textures[0], u, v);
                std::array<double, 3> mapped = normalised({2 * color[0] - 1, 2 * color[1] - 1, 2 * color[2] - 1});
                const double front = side == 0 ? 1 : -1;
                if (side == 1)
                    mapped[2] = -mapped[2];
                if (side == 2)
                    mapped = {-mapped[0], -mapped[1], -mapped[2]};
                const std::array<double, 3> wi = normalised({2 - 4 * u, 2 - 4 * v, z});
                turned += front * wi[2] * dot(wi, mapped) <= 0 ? 1 : 0;
                is_close = std::fabs(dot(wi, mapped)) < 1e-4;
                return expected_of(white.map, {0, 0, front}, mapped, wi, towards);
            };
            double largest = 0;
            // The shadowing divides by the square of the tilt, and normals turn by up to 2 of 5 texels' change at
            // their shortest, which is some 0.1: values err by ten times what those of a texture do.
            const double tolerance = 20 * rounding;
            for (std::uint32_t y = 0; y + 1 < size; ++y)
                for (std::uint32_t x = 0; x + 1 < size; ++x) {
                    bool is_close = false, is_close_right = false;
                    const double value = expected(x, y, is_close), right = expected(x + 1, y, is_close_right);
                    close += is_close || is_close_right ? 1 : 0;
                    if (is_close || is_close_right)
                        continue;
                    ASSERT_NEAR(layer(image, "primal", 0, x, y), value, tolerance)
                        << flags << side << ": " << x << ", " << y;
                    ASSERT_NEAR(layer(image, "dx", 0, x, y), right - value, 2 * tolerance)
                        << flags << side << ": " << x << ", " << y;
                    largest = worse(largest, value);
                }
            EXPECT_GT(largest, 0.5);
            EXPECT_GT(turned, 50u);
            EXPECT_LT(close, 10u);
        }
}

/// A map of nothing but the surface's own normal, or of one height, leaves the image as it is.
TEST_P(NormalMaps, ThatTurnNothingChangeNothing) {
    const char *method = "pt"; // of gpt and sppm the kernels take longer than the test is worth
    {
        std::vector<Image> images;
        for (const auto kind : {NormalTexture::Kind::none, NormalTexture::Kind::normal, NormalTexture::Kind::bump}) {
            Texture texture = random_texture(3, 3, Bitmap::Format::real, true);
            auto bitmap = std::make_shared<Bitmap>(*texture.bitmap);
            for (std::size_t i = 0; i < bitmap->words.size(); ++i)
                bitmap->words[i] = std::bit_cast<std::uint32_t>(i % 3 == 2 ? 1.0f : 0.5f);
            texture.bitmap = bitmap;
            SceneMaker maker(16, 16);
            maker.look({0, 0.5, 3}, {0, 0, 0}, 45);
            maker.lamp({0, 1.9f, 0.5f}, 0.5f, 0.5f, 5, maker.material(diffuse(0)));
            maker.scene.settings.max_depth = 5;
            Bsdf bsdfs[3] = {diffuse(0.7), Bsdf(), Bsdf()};
            bsdfs[1].kind = BsdfKind::roughconductor_ggx;
            bsdfs[1].alpha_u = 0.4f, bsdfs[1].alpha_v = 0.2f;
            bsdfs[2].kind = BsdfKind::dielectric;
            for (Bsdf &bsdf : bsdfs)
                if (kind != NormalTexture::Kind::none) {
                    bsdf.map = map_of(maker.scene, texture, kind);
                    bsdf.map.turns_over = bsdf.map.shadows = true;
                }
            maker.cube(maker.material(two_sided(bsdfs[0], bsdfs[0])));
            for (Vector3 &p : maker.scene.meshes.back().positions)
                p = {2 * p.x, 2 * p.y, 4 * p.z};
            maker.sphere({-0.6f, 0, 0}, 0.5f, maker.material(bsdfs[1]));
            maker.sphere({0.6f, 0, 0}, 0.5f, maker.material(bsdfs[2]));
            RenderOptions options;
            options.photons = 20000;
            images.push_back(render(maker.scene, options, method).image);
        }
        for (const std::size_t other : {1, 2}) {
            std::size_t off = 0;
            for (std::uint32_t y = 0; y < 16; ++y)
                for (std::uint32_t x = 0; x < 16; ++x) {
                    const double value = pixel(images[0], x, y);
                    // To rounding, which glass magnifies; where it decides what a path meets, a sample is another.
                    off += std::fabs(pixel(images[other], x, y) - value) > 1e-3 * value ? 1 : 0;
                }
            std::printf("%s, map %zu: %zu pixels differ\n", method, other, off);
            EXPECT_LE(off, 5u) << method << ", map " << other; // of 256
        }
    }
}

/// Photons and paths see the same, also where normals turn over: light paths must know who looks.
TEST_P(NormalMaps, PhotonsMeetThem) {
    SceneMaker maker(16, 64);
    maker.look({0, 0, 0.95}, {0, 0, 0}, 90);
    Bsdf bsdf = diffuse(0.8);
    Texture texture = random_texture();
    texture.scale = {1, 1, 0.8f};
    bsdf.map = map_of(maker.scene, texture, NormalTexture::Kind::normal);
    bsdf.map.turns_over = bsdf.map.shadows = true;
    maker.cube(maker.material(bsdf), -1, true);
    maker.lamp({0, 0.9f, 0}, 0.5f, 0.5f, 5, maker.material(diffuse(0)));
    maker.scene.settings.max_depth = 6;
    expect_photons_see_what_paths_see(maker.scene);
}

} // namespace
} // namespace gradus::testing
