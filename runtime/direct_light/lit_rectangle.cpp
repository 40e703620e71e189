#include "runtime/direct_light/lit_rectangle.h"

#include "kernels/shared/scene_records.h"
#include "runtime/scene/transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace gradus {

using namespace lib_float;

namespace {

Double3 vector_at(const float *field) { return {field[0], field[1], field[2]}; }

/// Points whose convex hull holds the light; none of a light that has no surface.
std::vector<Double3> corners_of(std::uint32_t kind, const float *light) {
    const Double3 p = vector_at(light + light_p_x);
    if (kind == light_kind_triangle)
        return {p, add(p, vector_at(light + light_e1_x)), add(p, vector_at(light + light_e2_x))};
    if (kind != light_kind_sphere)
        return {};
    const double radius = light[light_e1_x];
    std::vector<Double3> corners;
    for (int corner = 0; corner < 8; ++corner)
        corners.push_back(
            add(p, {corner & 1 ? radius : -radius, corner & 2 ? radius : -radius, corner & 4 ? radius : -radius}));
    return corners;
}

/// [low, high] of the full film, in pixels, as pixels of a crop that begins at `first`; one more at either side, for
/// rounding.
std::pair<std::uint32_t, std::uint32_t> pixels_between(double low, double high, double first, double count) {
    const double begin = std::clamp(std::floor(low) - 1 - first, 0.0, count);
    const double end = std::clamp(std::ceil(high) + 1 - first, begin, count);
    return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

} // namespace

PixelRectangle lit_rectangle(const SceneTables &tables, const FilmSettings &film) {
    const PixelRectangle all = {0, 0, film.crop_width, film.crop_height};
    if (tables.environment_light < tables.light_count || tables.camera_kind != Camera::Kind::perspective)
        return all;
    // The direction through the point (x, y) of the film is corner + x right + y down: where a point appears is solved
    // for by Cramer's rule.
    const Double3 origin = vector_at(&tables.camera[camera_origin_x]),
                  corner = vector_at(&tables.camera[camera_corner_x]),
                  right = vector_at(&tables.camera[camera_right_x]), down = vector_at(&tables.camera[camera_down_x]);
    const Double3 film_normal = cross(right, down), of_x = cross(down, corner), of_y = cross(corner, right);
    const double volume = dot(corner, film_normal);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    double low_x = infinity, high_x = -infinity, low_y = infinity, high_y = -infinity;
    for (std::uint32_t number = 0; number < tables.light_count; ++number)
        for (const Double3 &point : corners_of(tables.light_kinds[number], &tables.lights[number * light_stride])) {
            const Double3 way = subtract(point, origin);
            const double along = dot(way, film_normal);
            if (!(along / volume > 1e-6 * tables.scene_diameter))
                return all;
            const double x = dot(way, of_x) / along, y = dot(way, of_y) / along;
            low_x = std::min(low_x, x);
            high_x = std::max(high_x, x);
            low_y = std::min(low_y, y);
            high_y = std::max(high_y, y);
        }
    if (low_x > high_x)
        return {};
    PixelRectangle found;
    std::tie(found.left, found.right) = pixels_between(low_x, high_x, film.crop_x, film.crop_width);
    std::tie(found.top, found.bottom) = pixels_between(low_y, high_y, film.crop_y, film.crop_height);
    return found.width() == 0 || found.height() == 0 ? PixelRectangle() : found;
}

} // namespace gradus
