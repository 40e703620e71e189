/* The light that a ray finds where it meets a surface. */
#ifndef GRADUS_LIB_LIGHT_FOUND_H
#define GRADUS_LIB_LIGHT_FOUND_H
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_SPHERES TRAIT_TEXTURED_LIGHTS
#include "kernels/lib/hit_uv.h"
#include "kernels/lib/light.h"
#include "kernels/lib/light_texture.h"
#include "kernels/lib/scene_hit.h"

GRADUS_LIB_BEGIN

typedef struct {
    rgb radiance; /* 0 from behind, and where nothing is emitted */
    real pdf; /* with which light sampling finds the point, by solid angle at the ray's origin; with a tree, once the
                 light's leaf is reached (kernels/lib/light_tree.h) */
    uint light;
    GRADUS_NOT_IN_REGISTERS
} light_found;

#if LIGHTS_HAVE_SURFACE_TEXTURES || !defined(__OPENCL_VERSION__)
/* What light number `light`, that of a surface, is times where a ray has met it. facing: 1 or -1, of a sphere. */
GRADUS_FN rgb light_texture_on(GRADUS_GLOBAL const uint *light_textures, GRADUS_GLOBAL const real *triangle_texcoords,
                               GRADUS_GLOBAL const real *sphere_axes, GRADUS_GLOBAL const uint *textures,
                               GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels, uint unit,
                               uint triangle_count, uint light, uint primitive, primitive_hit hit, real facing) {
    vec3 on_sphere = v3(R(0), R(0), R(1));
    (void)sphere_axes, (void)facing;
#if TRAIT_SPHERES
    on_sphere = sphere_place(sphere_axes, unit, SPHERE_OF(primitive), v3_scale(hit.normal, facing));
#endif
    const texture_point point = hit_texture_point(triangle_texcoords, unit, triangle_count, primitive, hit, on_sphere);
    return light_texture_at(textures, texture_reals, texels, unit,
                            FIELD_OF(light_texture, light_textures, light, texture), point);
}
#endif

/* named: the light that the primitive is, or no_light; the record after the last light's is that of a black one. With
 * TRAIT_TEXTURED_LIGHTS its radiance is that of the place. */
GRADUS_FN light_found light_found_as(uint named, GRADUS_GLOBAL const real *lights, uint light_count, uint unit,
                                     uint triangle_count, uint primitive, primitive_hit hit, vec3 origin,
                                     vec3 direction LIGHT_TEXTURE_PARAMETERS) {
    (void)triangle_count;
    const real side = -v3_dot(hit.normal, direction);
    const vec3 connection = v3_sub(hit.position, origin);
    const real distance_squared = v3_dot(connection, connection);
    const uint light = named < light_count ? named : light_count;
    const real inverse_area = FIELD_OF(light, lights, light, inverse_area);
    real pdf = light_area_pdf(inverse_area, distance_squared, side);
#if TRAIT_LIGHT_SPHERE
    const vec3 to_center = v3_sub(FIELD_V3(light, lights, light, p), origin);
    const real of_sphere = light_sphere_pdf(FIELD_OF(light, lights, light, e1_x), FIELD_OF(light, lights, light, e1_y),
                                            inverse_area, v3_dot(to_center, to_center), distance_squared, side);
    pdf = TRAIT_LIGHT_TRIANGLE && primitive < triangle_count ? pdf : of_sphere;
#endif
    const real seen = side > R(0) ? R(1) : R(0);
    light_found found;
    found.radiance = rgb_scale(FIELD_RGB(light, lights, light, value), seen);
#if LIGHTS_HAVE_SURFACE_TEXTURES
    (void)light_pictures;
    found.radiance = rgb_mul(found.radiance, light_texture_on(light_textures, triangle_texcoords, sphere_axes, textures,
                                                              texture_reals, texels, unit, triangle_count, light,
                                                              primitive, hit, FIELD_OF(light, lights, light, e1_y)));
#endif
    found.pdf = pdf * FIELD_OF(light, lights, light, probability);
    found.light = light;
    return found;
}

/* The same for any primitive. */
GRADUS_FN light_found light_found_at(GRADUS_GLOBAL const uint *primitive_light, GRADUS_GLOBAL const real *lights,
                                     uint light_count, uint unit, uint triangle_count, uint primitive,
                                     primitive_hit hit, vec3 origin, vec3 direction LIGHT_TEXTURE_PARAMETERS) {
    return light_found_as(LIGHT_OF_PRIMITIVE(primitive_light, primitive), lights, light_count, unit, triangle_count,
                          primitive, hit, origin, direction LIGHT_TEXTURE_ARGUMENTS);
}

GRADUS_LIB_END
#endif
