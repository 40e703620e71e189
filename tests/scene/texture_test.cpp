// Textures on the host, and the kernels' lookups against them.
#define TRAIT_TEXTURED 1
#define TRAIT_TEXTURES 8191
#include "kernels/lib/texture_lookup.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/texture.h"
#include "runtime/scene/texture_tables.h"
#include "tests/support/textures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace gradus::testing {
namespace {

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
                    lib_float::texture_lookup(tables.textures.data(), tables.texture_reals.data(), tables.texels.data(),
                                              tables.texture_decode.data(), 1, std::uint32_t(i), {u, v, 0, 0, 0});
                const double scale = std::max({texture.scale[0], texture.scale[1], texture.scale[2]});
                const double tolerance = (2 * rounding + 4 * 0x1p-24) * scale;
                const float values[] = {actual.r, actual.g, actual.b};
                for (int c = 0; c < 3; ++c) {
                    ASSERT_NEAR(values[c], expected[c], tolerance)
                        << "texture " << i << " at " << u << ", " << v << ", channel " << c;
                    largest = std::max(largest, std::fabs(values[c] - expected[c]) / tolerance);
                }
                ++compared;
            }
    EXPECT_GT(compared, 100000u);
    EXPECT_GT(largest, 0.02); // the tolerance is no wider than it must be
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
                lib_float::texture_lookup(tables.textures.data(), tables.texture_reals.data(), tables.texels.data(),
                                          tables.texture_decode.data(), 1, 1, {u, v, 0, 0, 0});
            ASSERT_EQ(value.g, 0.25f) << u << ", " << v;
        }
    }
}

} // namespace
} // namespace gradus::testing
