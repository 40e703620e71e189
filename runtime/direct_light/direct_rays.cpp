#include "runtime/direct_light/direct_rays.h"

#define TRAIT_LIGHT_TRIANGLE 1
#define TRAIT_LIGHT_SPHERE 1
#define TRAIT_LIGHT_CONSTANT 1
#define TRAIT_LIGHT_ENVIRONMENT 1
#define TRAIT_LIGHT_TEXTURES (2 * textures_of_meshes - 1)
#include "kernels/lib/escaped_light.h"
#include "kernels/lib/light_texture.h"
#include "kernels/shared/tables.h"
#include "runtime/scene/environment_map.h"

namespace gradus {

using namespace lib_float;

namespace {

constexpr std::uint32_t unit = 1; // of FIELD_OF

texture_point place_of(const SceneTables &tables, std::uint32_t light, std::uint32_t primitive,
                       const primitive_hit &hit) {
    if (primitive < tables.triangle_count) {
        const std::array<float, 6> uv = tables.texcoords(primitive);
        const std::array<std::uint32_t, 3> corners = tables.triangle(primitive).corners;
        const triangle_uv of_corners{uv[0], uv[1], uv[2], uv[3], uv[4], uv[5], corners[0], corners[1], corners[2]};
        return point_of_triangle(of_corners, primitive, hit.u, hit.v);
    }
    const float facing = FIELD_OF(light, tables.lights.data(), light, e1_y);
    return point_of_sphere(
        sphere_place(tables.sphere_axes.data(), unit, primitive - tables.triangle_count, v3_scale(hit.normal, facing)));
}

} // namespace

rgb DirectRays::light_along(std::size_t i, bool as_one) const {
    const float *lights = tables_.lights.data();
    const std::uint32_t primitive = camera_rays_.primitive(i);
    if (primitive == ray_escaped) {
        if (as_one || !tables_.environment)
            return FIELD_RGB(light, lights, tables_.environment_light, value);
        const EnvironmentMap &map = *tables_.environment;
        return light_escaped(lights, tables_.environment_light, unit, camera_rays_.direction(i), map.texels.data(),
                             map.cells.data(), map.strips.data(), map.columns, map.rows,
                             std::uint32_t(map.strips.size() / 2))
            .radiance;
    }
    const std::uint32_t light = tables_.light_of(primitive);
    if (light == no_light)
        return rgb_gray(0);
    const primitive_hit hit = camera_rays_.hit(tables_, i);
    const rgb found = light_found_as(light, lights, tables_.light_count, unit, tables_.triangle_count, primitive, hit,
                                     camera_rays_.origin(i), camera_rays_.direction(i))
                          .radiance;
    return tables_.light_textures.empty() ? found : textured(found, light, primitive, hit, as_one);
}

/// The light of a surface that may have a texture; `as_one`: as if it were its mean.
rgb DirectRays::textured(rgb found, std::uint32_t light, std::uint32_t primitive, const primitive_hit &hit,
                         bool as_one) const {
    if (texture_is_absent(FIELD_OF(light_texture, tables_.light_textures.data(), light, texture)))
        return found;
    const float *mean = &tables_.light_means[std::size_t(light) * 3];
    if (as_one)
        return rgb_max(found) > 0 ? rgb3(mean[0], mean[1], mean[2]) : found;
    const std::uint32_t texture = FIELD_OF(light_texture, tables_.light_textures.data(), light, texture);
    return rgb_mul(found, light_texture_at(tables_.textures.data(), tables_.texture_reals.data(), tables_.texels.data(),
                                           unit, texture, place_of(tables_, light, primitive, hit)));
}

} // namespace gradus
