/* Textures of lights: what a light's value is times, at a point of a surface or of the picture that it throws.
 *
 * The stage `material` leaves it for what rays meet. Light samples and first rays of light paths choose their points
 * themselves, so they look it up here. */
#ifndef GRADUS_LIB_LIGHT_TEXTURE_H
#define GRADUS_LIB_LIGHT_TEXTURE_H
//! traits: TRAIT_TEXTURED_LIGHTS
#include "kernels/lib/surface_uv.h"

#if TRAIT_TEXTURED_LIGHTS
#define LIGHT_TEXTURE_PARAMETERS                                                                                       \
    , GRADUS_GLOBAL const uint *light_textures, GRADUS_GLOBAL const real *light_pictures,                              \
        GRADUS_GLOBAL const real *triangle_texcoords, GRADUS_GLOBAL const real *sphere_axes,                           \
        GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels, \
        GRADUS_GLOBAL const real *texture_decode
#define LIGHT_TEXTURE_ARGUMENTS                                                                                        \
    , light_textures, light_pictures, triangle_texcoords, sphere_axes, textures, texture_reals, texels, texture_decode
#else
#define LIGHT_TEXTURE_PARAMETERS
#define LIGHT_TEXTURE_ARGUMENTS
#endif

#if TRAIT_TEXTURED_LIGHTS || !defined(__OPENCL_VERSION__)

GRADUS_LIB_BEGIN

/* What a light's value is times at a point of it; 1 where it has no texture. */
GRADUS_FN rgb light_texture_at(GRADUS_GLOBAL const uint *light_textures, GRADUS_GLOBAL const uint *textures,
                               GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels,
                               GRADUS_GLOBAL const real *texture_decode, uint unit, uint light, texture_point point) {
    const uint number = FIELD_OF(light_texture, light_textures, light, texture);
    const int is_even = number == texture_none;
    const rgb looked_up =
        texture_lookup(textures, texture_reals, texels, texture_decode, unit, is_even ? 0u : number, point);
    return rgb_select(is_even, rgb_gray(R(1)), looked_up);
}

/* The place of the picture that goes into direction d, a unit vector from the light; ahead: its cosine to the axis. */
GRADUS_FN texture_point point_of_picture(GRADUS_GLOBAL const real *light_pictures, uint unit, uint light, vec3 d,
                                         real ahead) {
    const real inverse = R(1) / r_max(ahead, R(1e-6));
    texture_point point = point_of_nothing();
    point.u = R(0.5) + v3_dot(FIELD_V3(picture, light_pictures, light, along_u), d) * inverse;
    point.v = R(0.5) + v3_dot(FIELD_V3(picture, light_pictures, light, along_v), v3_after(d, point.u)) * inverse;
    return point;
}

/* Intensity of a projector over its irradiance on a plane at distance 1, by a place of the picture: one over the cosine
 * cubed, which is what a plane loses; nothing beside the picture. */
GRADUS_FN real light_projector_profile(texture_point point, real ahead) {
    const int is_inside = (ahead > R(1e-6)) & (r_abs(point.u - R(0.5)) <= R(0.5)) & (r_abs(point.v - R(0.5)) <= R(0.5));
    const real inverse = R(1) / r_max(ahead, R(1e-6));
    return is_inside ? inverse * inverse * inverse : R(0);
}

GRADUS_LIB_END

#endif
#endif
