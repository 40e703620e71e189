// Textures on the host, and the kernels' lookups against them.
#define TRAIT_TEXTURED 1
#include <gtest/gtest.h>

// After GoogleTest, which has template parameters of the names of its macros.
#include "kernels/lib/mapped_normal.h"
#include "kernels/lib/normal_map.h"
#include "kernels/lib/texture_gradient.h"
#include "kernels/lib/texture_lookup.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/texture.h"
#include "runtime/scene/texture_tables.h"
#include "tests/support/textures.h"
#include "tests/support/worse.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>

namespace gradus::testing {
namespace {

constexpr int all_features = 2 * textures_of_meshes - 1;
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();

/// A gray picture of these texels, row by row.
Texture picture(std::uint32_t width, const std::vector<float> &texels) {
    auto bitmap = std::make_shared<Bitmap>();
    bitmap->resize(width, std::uint32_t(texels.size()) / width, Bitmap::Format::real, false);
    for (std::size_t i = 0; i < texels.size(); ++i)
        bitmap->words[i] = std::bit_cast<std::uint32_t>(texels[i]);
    Texture texture;
    texture.bitmap = bitmap;
    return texture;
}

double value_at(const Texture &texture, double u, double v) { return texture_value(texture, u, v)[1]; }

TEST(Texture, FirstRowIsAtTheTopWhereVIsZero) {
    Texture texture = picture(2, {0.1f, 0.2f, 0.3f, 0.4f});
    texture.is_nearest = true;
    EXPECT_FLOAT_EQ(float(value_at(texture, 0.2, 0.2)), 0.1f);
    EXPECT_FLOAT_EQ(float(value_at(texture, 0.7, 0.2)), 0.2f);
    EXPECT_FLOAT_EQ(float(value_at(texture, 0.2, 0.7)), 0.3f);
    EXPECT_FLOAT_EQ(float(value_at(texture, 0.7, 0.7)), 0.4f);
}

// Values that Mitsuba 3.9 gives for the first row of a picture of 3 x 2.
TEST(Texture, WrapsAsMitsuba) {
    Texture texture = picture(3, {0.2f, 0.5f, 0.8f, 0.2f, 0.5f, 0.8f});
    const double places[] = {-1.3, -0.3, -0.05, 0.05, 0.3, 0.97, 1.05, 1.4, 2.2};
    const std::vector<double> expected[] = {{0.68, 0.68, 0.59, 0.41, 0.32, 0.554, 0.41, 0.41, 0.23},
                                            {0.68, 0.32, 0.20, 0.20, 0.32, 0.80, 0.80, 0.59, 0.23},
                                            {0.20, 0.20, 0.20, 0.20, 0.32, 0.80, 0.80, 0.80, 0.80}};
    for (const Texture::Wrap wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp}) {
        texture.wrap = wrap;
        for (std::size_t i = 0; i < std::size(places); ++i)
            EXPECT_NEAR(value_at(texture, places[i], 0.25), expected[int(wrap)][i], 1e-6) << places[i];
    }
}

TEST(Texture, CoordinatesThatAreNoNumbersReadAsZero) {
    for (const Texture::Wrap wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp}) {
        Texture texture = random_texture();
        texture.wrap = wrap;
        for (const float u : {infinity, -infinity, not_a_number})
            EXPECT_EQ(texture_value(texture, u, u), texture_value(texture, 0, 0));
    }
}

TEST(Texture, RangeIsOfItsTexels) {
    Texture texture = random_texture(16, 16);
    texture.is_srgb = true;
    const TextureRange range = texture_range(texture);
    std::array<double, 3> mean{};
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (int c = 0; c < 3; ++c)
                mean[c] += texture_value(texture, (x + 0.5) / 16, (y + 0.5) / 16)[c] / 256;
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(range.mean[c], mean[c], 1e-12);
        EXPECT_LE(range.least[c], mean[c]);
        EXPECT_GE(range.most[c], mean[c]);
    }
    texture.lowest = 0.25f;
    EXPECT_EQ(texture_range(texture).least[0], 0.25);
}

/// Of so large a picture each value is decoded once, and rows are summed on all cores.
TEST(Texture, RangeOfLargePicturesIsOfTheirTexels) {
    for (const bool is_color : {true, false}) {
        auto bitmap = std::make_shared<Bitmap>();
        bitmap->resize(300, 301, Bitmap::Format::half, is_color);
        std::mt19937 random(1);
        std::array<double, 3> mean{}, least{9, 9, 9}, most{-9, -9, -9};
        for (std::uint32_t y = 0; y < bitmap->height; ++y)
            for (std::uint32_t x = 0; x < bitmap->width; ++x)
                for (int c = 0; c < 3; ++c) {
                    // From -2 to 2, of each channel its own share of them.
                    const std::uint32_t bits = (random() & 0x8000u) | random() % (0x3000u + 0x800u * unsigned(c));
                    if (is_color || c == 0)
                        bitmap->set(x, y, c, bits);
                    const double value = 0.5 * (c + 1) * bitmap->channel(x, y, is_color ? c : 0);
                    mean[c] += value / (300 * 301);
                    least[c] = std::min(least[c], value);
                    most[c] = std::max(most[c], value);
                }
        Texture texture;
        texture.bitmap = bitmap;
        texture.lowest = -9;
        texture.highest = 9;
        texture.scale = {0.5f, 1, 1.5f};
        const TextureRange range = texture_range(texture);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(range.mean[c], mean[c], 1e-12);
            EXPECT_EQ(range.least[c], least[c]);
            EXPECT_EQ(range.most[c], most[c]);
        }
    }
}

TEST(Texture, HalvesAreNumbers) {
    EXPECT_EQ(half_value(0x3c00), 1);
    EXPECT_EQ(half_value(0xc000), -2);
    EXPECT_EQ(half_value(1), 0x1p-24);
    EXPECT_EQ(half_value(0x3ff), 1023 * 0x1p-24);
    EXPECT_EQ(half_value(0x7bff), 65504);
}

/// All formats, wraps, filters and maps; the last is a checkerboard.
std::vector<Texture> textures_of_all_sorts() {
    std::vector<Texture> textures;
    for (const auto format : {Bitmap::Format::byte, Bitmap::Format::word, Bitmap::Format::half, Bitmap::Format::real})
        for (const bool is_color : {false, true})
            for (const auto wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp})
                for (const bool is_nearest : {false, true}) {
                    Texture texture = random_texture(7, 5, format, is_color, unsigned(textures.size() + 1));
                    texture.wrap = wrap;
                    texture.is_nearest = is_nearest;
                    texture.is_srgb = format == Bitmap::Format::byte && !is_nearest;
                    if (textures.size() % 3 == 1)
                        texture.to_uv = {1.5f, 0.25f, 0.125f, -0.5f, 2, -0.75f};
                    if (textures.size() % 5 == 2) {
                        texture.scale = {0.5f, 2, 1};
                        texture.lowest = 0.125f;
                        texture.highest = 0.75f;
                    }
                    textures.push_back(texture);
                }
    for (const auto along_v : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp}) {
        textures.push_back(random_texture(4, 3));
        textures.back().wrap = Texture::Wrap::mirror;
        textures.back().wrap_v = along_v;
    }
    textures.push_back(random_texture(1, 1));
    textures.push_back(random_texture(1, 9, Bitmap::Format::word, false));
    Texture board;
    board.kind = Texture::Kind::checkerboard;
    board.to_uv = {3, 0, 0.25f, 0, 2, 0};
    textures.push_back(board);
    return textures;
}

/// How far (u, v) is, in texels or fields, from where the texture jumps; infinite where it does not.
double distance_to_jump(const Texture &texture, double u, double v) {
    const bool is_board = texture.kind == Texture::Kind::checkerboard;
    if (!is_board && !texture.is_nearest)
        return INFINITY;
    const auto &m = texture.to_uv;
    const double s = (m[0] * u + m[1] * v + m[2]) * (is_board ? 2 : texture.bitmap->width);
    const double t = (m[3] * u + m[4] * v + m[5]) * (is_board ? 2 : texture.bitmap->height);
    return std::min(std::fabs(s - std::round(s)), std::fabs(t - std::round(t)));
}

TEST(TextureLookup, IsTheHostsToRounding) {
    Scene scene;
    scene.textures = textures_of_all_sorts();
    SceneTables tables;
    add_textures(scene, tables);
    std::mt19937 random(1);
    std::vector<float> places = {0,      1,    -1,    0.5f,  1e-8f,  -1e-8f,   1 - 0x1p-24f, 1 + 0x1p-23f, 2,
                                 -3.75f, 1e4f, -1e6f, 1e30f, -1e30f, infinity, -infinity,    not_a_number};
    for (int i = 0; i < 60; ++i)
        places.push_back(float(random()) * 0x1p-30f - 2);
    std::size_t compared = 0;
    double largest = 0;
    for (std::size_t i = 0; i < scene.textures.size(); ++i)
        for (const float u : places)
            for (const float v : places) {
                const Texture &texture = scene.textures[i];
                const bool is_finite = std::isfinite(u) && std::isfinite(v);
                if (!is_finite && texture.to_uv != Texture().to_uv)
                    continue; // which of both coordinates is lost is a matter of the order of sums
                // A coordinate is rounded some four times, by 2^-24 of the largest of its terms; a texel is as wide as
                // 1 over the size, and values differ by 1 at most.
                const double reach = is_finite ? std::max({1.0, 4.0 * std::fabs(u), 4.0 * std::fabs(v)}) : 1;
                const double rounding = 4 * 0x1p-24 * reach * 9;
                if (distance_to_jump(texture, is_finite ? u : 0, is_finite ? v : 0) <= rounding || rounding > 1)
                    continue;
                const std::array<double, 3> expected = texture_value(texture, u, v);
                const lib_float::rgb actual =
                    lib_float::texture_lookup(all_features, 0u, tables.textures.data(), tables.texture_reals.data(),
                                              tables.texels.data(), 1, std::uint32_t(i), {u, v, 0, 0, 0, 0, 0, 0});
                const double scale = std::max({texture.scale[0], texture.scale[1], texture.scale[2]});
                const double tolerance = (2 * rounding + 4 * 0x1p-24) * scale;
                const float values[] = {actual.r, actual.g, actual.b};
                for (int c = 0; c < 3; ++c) {
                    ASSERT_NEAR(values[c], expected[c], tolerance)
                        << "texture " << i << " at " << u << ", " << v << ", channel " << c;
                    largest = worse(largest, std::fabs(values[c] - expected[c]) / tolerance);
                }
                ++compared;
            }
    EXPECT_GT(compared, 100000u);
    EXPECT_GT(largest, 0.02); // the tolerance is no wider than it must be
}

double height_at(const Texture &texture, double u, double v) {
    const std::array<double, 3> value = texture_value(texture, u, v);
    return 0.212671 * value[0] + 0.715160 * value[1] + 0.072169 * value[2];
}

/// Slopes are those of finite differences, where these do not reach across the middle of a texel.
TEST(TextureGradient, IsThatOfTheTexture) {
    Scene scene;
    for (Texture texture : textures_of_all_sorts()) {
        texture.lowest = -100, texture.highest = 100; // where it is clamped it has no slope of its own
        scene.textures.push_back(texture);
    }
    SceneTables tables;
    add_textures(scene, tables);
    std::mt19937 random(1);
    std::size_t compared = 0, sloping = 0;
    for (int i = 0; i < 20000; ++i) {
        const std::size_t number = random() % scene.textures.size();
        const Texture &texture = scene.textures[number];
        const float u = float(random()) * 0x1p-30f - 2, v = float(random()) * 0x1p-30f - 2;
        const auto &m = texture.to_uv;
        const double s = m[0] * u + m[1] * v + m[2], t = m[3] * u + m[4] * v + m[5];
        const bool is_flat = texture.is_nearest || texture.kind == Texture::Kind::checkerboard;
        const double width = texture.bitmap ? texture.bitmap->width : 1;
        const double height = texture.bitmap ? texture.bitmap->height : 1;
        const double x = s * width - 0.5, y = t * height - 0.5;
        // Steps of 1e-4 go up to 2e-4 * 2 * 9 texels; edges of the picture are half a texel from middles.
        if (std::min(std::fabs(2 * x - std::round(2 * x)), std::fabs(2 * y - std::round(2 * y))) < 0.01)
            continue;
        constexpr double step = 1e-4;
        const double by_u = (height_at(texture, u + step, v) - height_at(texture, u - step, v)) / (2 * step);
        const double by_v = (height_at(texture, u, v + step) - height_at(texture, u, v - step)) / (2 * step);
        const lib_float::texture_slope slope =
            lib_float::texture_gradient(all_features, 0u, tables.textures.data(), tables.texture_reals.data(),
                                        tables.texels.data(), 1, std::uint32_t(number), u, v);
        // Bilinear: central differences are exact but for rounding; shares of texels err by 2^-24 of 4 coordinates
        // times 9 texels, and slopes change by twice the texels' number along the other axis, here times 4.
        const double tolerance = 1e-3 + 1e-4 * (std::fabs(by_u) + std::fabs(by_v));
        ASSERT_NEAR(slope.u, is_flat ? 0 : by_u, tolerance) << "texture " << number << " at " << u << ", " << v;
        ASSERT_NEAR(slope.v, is_flat ? 0 : by_v, tolerance) << "texture " << number << " at " << u << ", " << v;
        ++compared;
        sloping += std::fabs(slope.u) > 0.1 && std::fabs(slope.v) > 0.1 ? 1 : 0;
    }
    EXPECT_GT(compared, 15000u);
    EXPECT_GT(sloping, 5000u);
}

using lib_float::v3;
using lib_float::vec3;

double distance(vec3 a, vec3 b) { return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z); }

/// A plane raised along its normal: its normal there by finite differences in double.
TEST(NormalMaps, BumpsAreThoseOfTheDisplacedPlane) {
    const std::array<double, 3> along_u{0.5, 0.3, 0}, along_v{-0.2, 0.7, 0}; // the plane z = 0
    const auto height = [](double u, double v) { return 0.3 * u * u - 0.2 * u * v + 0.1 * std::sin(v); };
    for (const double facing : {1.0, -1.0}) // of the plane's front
        for (double u = -1; u <= 1; u += 0.25)
            for (double v = -1; v <= 1; v += 0.25) {
                const auto point = [&](double du, double dv) {
                    return std::array<double, 3>{(u + du) * along_u[0] + (v + dv) * along_v[0],
                                                 (u + du) * along_u[1] + (v + dv) * along_v[1],
                                                 facing * height(u + du, v + dv)};
                };
                constexpr double h = 1e-5;
                std::array<double, 3> a, b;
                for (std::size_t i = 0; i < 3; ++i) {
                    a[i] = (point(h, 0)[i] - point(-h, 0)[i]) / (2 * h);
                    b[i] = (point(0, h)[i] - point(0, -h)[i]) / (2 * h);
                }
                double n[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
                const double scale = (n[2] * facing > 0 ? 1 : -1) / std::hypot(n[0], n[1], n[2]);
                const vec3 front = v3(0, 0, float(facing));
                const auto surface =
                    lib_float::textured_surface_at(front, front, v3(float(along_u[0]), float(along_u[1]), 0),
                                                   v3(float(along_v[0]), float(along_v[1]), 0));
                const vec3 normal =
                    lib_float::normal_of_height(surface, float((height(u + h, v) - height(u - h, v)) / (2 * h)),
                                                float((height(u, v + h) - height(u, v - h)) / (2 * h)));
                // Some ten roundings, in a frame whose axes are 50 degrees apart.
                EXPECT_LT(distance(normal, v3(float(n[0] * scale), float(n[1] * scale), float(n[2] * scale))),
                          20 * 0x1p-23);
            }
}

TEST(NormalMaps, LieInTheFrameOfTheSurface) {
    const vec3 normal = v3(0, 0.6f, 0.8f);
    const auto surface = lib_float::textured_surface_at(normal, normal, v3(2, 0, 0), v3(0, 4, -3));
    EXPECT_EQ(distance(lib_float::normal_of_color(surface, lib_float::rgb3(0.5f, 0.5f, 1)), normal), 0);
    EXPECT_LT(distance(lib_float::normal_of_color(surface, lib_float::rgb3(1, 0.5f, 0.5f)), v3(1, 0, 0)), 1e-7);
    // y along n x dp/du, whichever way v goes
    EXPECT_LT(distance(lib_float::normal_of_color(surface, lib_float::rgb3(0.5f, 1, 0.5f)), v3(0, 0.8f, -0.6f)), 1e-7);
    // No colour, no vector; no (u, v), no frame.
    EXPECT_EQ(distance(lib_float::normal_of_color(surface, lib_float::rgb_gray(0.5f)), normal), 0);
    for (const auto &[u, v] :
         {std::pair{v3(0, 0, 0), v3(0, 4, -3)}, {v3(2, 0, 0), v3(0, 0, 0)}, {normal, v3(2, 0, 0)}}) {
        const auto degenerate = lib_float::textured_surface_at(normal, normal, u, v);
        EXPECT_EQ(distance(lib_float::normal_of_color(degenerate, lib_float::rgb3(0.9f, 0.3f, 0.7f)), normal), 0);
        EXPECT_EQ(distance(lib_float::normal_of_height(degenerate, 1, 2), normal), 0);
    }
    // `twosided` mirrors; around it the surface itself is turned.
    const vec3 leaning = v3(0.6f, 0, 0.8f), up = v3(0, 0, 1);
    EXPECT_LT(distance(lib_float::normal_from_behind(up, leaning, 0), v3(0.6f, 0, -0.8f)), 1e-7);
    EXPECT_LT(distance(lib_float::normal_from_behind(up, leaning, 1), v3(-0.6f, 0, -0.8f)), 1e-7);
}

/// Values that Mitsuba 3.9 gives for a white diffuse BSDF under the normal (0.6, 0, 0.8): f cos pi.
TEST(NormalMaps, CountAsInMitsuba) {
    using namespace lib_float;
    const vec3 own = v3(0, 0, 1);
    const vec3 directions[] = {v3(0, 0, 1), v3(0.8f, 0, 0.6f), v3(-0.6f, 0, 0.8f), v3(-0.9f, 0, 0.435889894f),
                               v3(0.9f, 0, -0.435889894f)};
    const auto value = [&](uint flags, vec3 wi, vec3 wo) {
        mapped_normal map;
        map.normal = v3(0.6f, 0, 0.8f);
        map.flags = flags;
        const frame axes = frame_from_normal(mapped_normal_seen(map, own, wi));
        const vec3 local = frame_to_local(axes, wo);
        const bool is_seen = v3_dot(axes.n, wi) > 0;
        return is_seen ? std::max(local.z, 0.0f) * mapped_factor(flags, frame_to_local(axes, own), local) : 0;
    };
    const vec3 above = v3(0, 0.6f, 0.8f), aside = v3(-0.9f, 0, 0.435889894f);
    const struct {
        uint flags;
        vec3 wi;
        double expected[5];
    } cases[] = {{normal_map_there | normal_map_turns | normal_map_shadows, above, {0.8, 0.93174, 0.27728, 0, 0}},
                 {normal_map_there | normal_map_turns | normal_map_shadows, aside, {0.8, 0, 0.9903, 0.83055, 0}},
                 {normal_map_there | normal_map_turns, above, {0.8, 0.96, 0.28, 0, 0}},
                 {normal_map_there | normal_map_turns, aside, {0.8, 0, 1, 0.88871, 0}},
                 {normal_map_there, above, {0.8, 0.96, 0.28, 0, 0}},
                 {normal_map_there, aside, {0, 0, 0, 0, 0}}};
    for (const auto &c : cases)
        for (std::size_t i = 0; i < 5; ++i)
            EXPECT_NEAR(value(c.flags, c.wi, directions[i]), c.expected[i], 1e-5) << c.flags << ", direction " << i;
    // Without a map there is none of this.
    EXPECT_EQ(mapped_factor(0, own, v3(1, 0, -1e-8f)), 1);
}

/// Whatever the coordinates, no texel beyond the picture is read: the picture lies between others.
TEST(TextureLookup, StaysWithinThePicture) {
    Scene scene;
    for (const float value : {0.9f, 0.25f, 0.9f})
        scene.textures.push_back(picture(3, std::vector<float>(9, value)));
    SceneTables tables;
    for (Texture::Wrap wrap : {Texture::Wrap::repeat, Texture::Wrap::mirror, Texture::Wrap::clamp}) {
        scene.textures[1].wrap = wrap;
        tables = {};
        add_textures(scene, tables);
        std::mt19937 random(1);
        for (int i = 0; i < 100000; ++i) {
            const float u = std::bit_cast<float>(std::uint32_t(random()));
            const float v = std::bit_cast<float>(std::uint32_t(random()));
            const lib_float::rgb value =
                lib_float::texture_lookup(all_features, 0u, tables.textures.data(), tables.texture_reals.data(),
                                          tables.texels.data(), 1, 1, {u, v, 0, 0, 0, 0, 0, 0});
            ASSERT_EQ(value.g, 0.25f) << u << ", " << v;
        }
    }
}

} // namespace
} // namespace gradus::testing
