// Lights of every kind, as kernels choose and find them, with places from where they are seen. Who includes it has set
// the traits of kernels/lib before.
#pragma once

// Before kernels/: their short macro names are not for library headers.
#include <gtest/gtest.h>

#include "kernels/lib/escaped_light.h"
#include "kernels/lib/light_emission.h"
#include "kernels/lib/light_found.h"
#include "kernels/lib/light_sampling.h"
#include "runtime/scene/scene_tables.h"
#include "tests/support/chi_square.h"
#include "tests/support/small_scenes.h"
#include "tests/support/textures.h"

#include <cmath>
#include <numbers>

namespace gradus::testing {
namespace {

using namespace lib_float;

constexpr std::uint32_t unit = 1;       // of FIELD_OF
constexpr double rounding = 0x1p-24;    // half a unit in the last place of 1
constexpr std::uint32_t chart_side = 6; // cells along each side of a chart
constexpr std::uint32_t chart_cells = chart_side * chart_side;
constexpr double pi = std::numbers::pi;

inline Double3 exact(vec3 v) { return {v.x, v.y, v.z}; }
inline vec3 single(const Double3 &v) { return v3(float(v[0]), float(v[1]), float(v[2])); }

/// A cell of the unit square.
inline std::uint32_t chart_cell(double a, double b) {
    const auto along = [](double x) { return std::uint32_t(std::clamp(int(x * chart_side), 0, int(chart_side) - 1)); };
    return along(a) * chart_side + along(b);
}

/// The share of a turn from x to y.
inline double turn_of(double x, double y) {
    const double turns = std::atan2(y, x) / (2 * pi);
    return turns < 0 ? turns + 1 : turns;
}

/// The cell of a direction or a place around `axis`, by the share of the whole that lies below it, and the turn.
inline std::uint32_t cell_around(const Double3 &axis, const Double3 &direction, double below) {
    const Double3 side = normalize(cross(std::fabs(axis[0]) < 0.9 ? Double3{1, 0, 0} : Double3{0, 1, 0}, axis));
    return chart_cell(below, turn_of(dot(direction, side), dot(direction, cross(axis, side))));
}

/// Of a triangle, by area: warp_uniform_triangle() undone.
inline std::uint32_t cell_of_triangle(const Double3 &p0, const Double3 &e1, const Double3 &e2, const Double3 &point) {
    const Double3 across = cross(e1, e2), to = subtract(point, p0);
    const double square = dot(across, across);
    const double first = dot(cross(to, e2), across) / square, second = dot(cross(e1, to), across) / square;
    return chart_cell((1 - first) * (1 - first), first < 1 ? second / (1 - first) : 0);
}

/// A scene and its tables.
struct Emitters {
    explicit Emitters(Scene built, const LightTreeFrom &tree_from = {})
        : scene(std::move(built)), tables(make_scene_tables(scene, with_all_traits(scene_traits(scene)), tree_from)) {
        primitive_of.assign(tables.light_count, 0);
        for (std::uint32_t i = 0; i < tables.primitive_count; ++i)
            if (tables.light_of(i) != no_light)
                primitive_of[tables.light_of(i)] = i;
    }

    float field(std::uint32_t light, int name) const { return tables.lights[light * light_stride + std::size_t(name)]; }
    Double3 vector(std::uint32_t light, int name) const {
        return {field(light, name), field(light, name + 1), field(light, name + 2)};
    }
    std::uint32_t kind(std::uint32_t light) const { return tables.light_kinds[light]; }

    Scene scene;
    SceneTables tables;
    std::vector<std::uint32_t> primitive_of; ///< by light
};

/// Arguments of kernels/lib that depend on traits.
#if TRAIT_LIGHT_ENVIRONMENT
#define ENVIRONMENT_OF(t)                                                                                              \
    , (t).environment->texels.data(), (t).environment->cells.data(), (t).environment->strips.data(),                   \
        (t).environment->columns, (t).environment->rows, std::uint32_t((t).environment->strips.size() / 2)
#else
#define ENVIRONMENT_OF(t)
#endif
#if TRAIT_TEXTURED_LIGHTS
#define LIGHT_TEXTURES_OF(t)                                                                                           \
    , (t).light_textures.data(), (t).light_pictures.data(), (t).triangle_texcoords.data(), (t).sphere_axes.data(),     \
        (t).textures.data(), (t).texture_reals.data(), (t).texels.data()
#else
#define LIGHT_TEXTURES_OF(t)
#endif

/// A texture of a lamp, bilinear between 3 x 2 texels from 0.5 to 1: the last of the scene's. As numbers, or as bytes
/// that are sRGB.
inline std::int32_t lamp_texture(SceneMaker &maker, unsigned seed, bool is_srgb = false) {
    const std::shared_ptr<const Bitmap> random = random_bitmap(3, 2, Bitmap::Format::real, true, seed);
    auto bitmap = std::make_shared<Bitmap>();
    bitmap->resize(3, 2, is_srgb ? Bitmap::Format::byte : Bitmap::Format::real, true);
    for (std::uint32_t y = 0; y < 2; ++y)
        for (std::uint32_t x = 0; x < 3; ++x)
            for (int c = 0; c < 3; ++c) {
                const double share = random->channel(x, y, c);
                const auto code = std::uint32_t(188 + 67 * share); // of 188 is 0.503
                bitmap->set(x, y, c, is_srgb ? code : std::bit_cast<std::uint32_t>(float(0.5 + 0.5 * share)));
            }
    Texture texture;
    texture.bitmap = bitmap;
    texture.is_srgb = is_srgb;
    texture.highest = 1e30f;
    maker.scene.textures.push_back(texture);
    return std::int32_t(maker.scene.textures.size()) - 1;
}

/// Lamps without textures: a rectangle, a ball, and a ball around all that shines inwards; two of them large in power.
inline void add_lamps(SceneMaker &maker) {
    const std::uint32_t black = maker.material(diffuse(0));
    maker.parallelogram({-1, 2, -0.5f}, {1.5f, 0.2f, 0}, {0.1f, 0, 1}, black,
                        maker.emitter(Emitter::Kind::area, {3, 2, 1}));
    maker.sphere({1.5f, 0.5f, 0.25f}, 0.4f, black, maker.emitter(Emitter::Kind::area, {1, 5, 2}));
    maker.sphere({0, 0, 0}, 20, black, maker.emitter(Emitter::Kind::area, {0.01f, 0.01f, 0.02f}), true);
}

/// Places among these: in the middle, close above and below the rectangle, close to the ball and within it, on its
/// tangent plane, and far away.
inline const std::vector<Double3> &lamp_places() {
    static const std::vector<Double3> places = {{0.3, 0.2, 0.1}, {-0.3, 2.08, 0}, {-0.3, 2.11, 0},   {1.1, 0.5, 0.251},
                                                {1.6, 0.6, 0.2}, {1.5, 0.9, 3},   {900, -400, 700.5}};
    return places;
}

} // namespace
} // namespace gradus::testing
