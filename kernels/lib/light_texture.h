/* Textures of lights: what a light's value is times, at a point of a surface or of the picture that it throws. Whoever
 * finds a light, chooses a point of one or sends light from there looks it up himself. TRAIT_LIGHT_TEXTURES has a bit
 * for each feature that some of these textures has (kernels/shared/texture.h). */
#ifndef GRADUS_LIB_LIGHT_TEXTURE_H
#define GRADUS_LIB_LIGHT_TEXTURE_H
//! traits: TRAIT_TEXTURED_LIGHTS TRAIT_LIGHT_TEXTURES
#include "kernels/lib/surface_uv.h"

/* Bits of TRAIT_TEXTURED_LIGHTS, as 0 or 1. */
#define LIGHTS_HAVE_SURFACE_TEXTURES (TRAIT_TEXTURED_LIGHTS & 1)
#define LIGHTS_HAVE_PICTURES ((TRAIT_TEXTURED_LIGHTS >> 1 | TRAIT_TEXTURED_LIGHTS >> 2) & 1)
#define LIGHTS_HAVE_PROJECTORS (TRAIT_TEXTURED_LIGHTS >> 2 & 1)

#if TRAIT_TEXTURED_LIGHTS
#define LIGHT_TEXTURE_PARAMETERS                                                                                       \
    , GRADUS_GLOBAL const uint *light_textures, GRADUS_GLOBAL const real *light_pictures,                              \
        GRADUS_GLOBAL const real *triangle_texcoords, GRADUS_GLOBAL const real *sphere_axes,                           \
        GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals, GRADUS_GLOBAL const uint *texels
#define LIGHT_TEXTURE_ARGUMENTS                                                                                        \
    , light_textures, light_pictures, triangle_texcoords, sphere_axes, textures, texture_reals, texels
#else
#define LIGHT_TEXTURE_PARAMETERS
#define LIGHT_TEXTURE_ARGUMENTS
#endif

#if TRAIT_TEXTURED_LIGHTS || !defined(__OPENCL_VERSION__)

GRADUS_LIB_BEGIN

/* What a light's value is times at a point of it, 1 where it has no texture. number: its texture, as in the light's
 * record of GRADUS_LIGHT_TEXTURE_FIELDS. */
GRADUS_FN rgb light_texture_at(GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals,
                               GRADUS_GLOBAL const uint *texels, uint unit, uint number, texture_point point) {
    const rgb looked_up =
        texture_lookup(TRAIT_LIGHT_TEXTURES, 0u, textures, texture_reals, texels, unit, texture_present(number), point);
    return rgb_select(texture_is_absent(number), rgb_gray(R(1)), looked_up);
}

/* The place of a picture that goes into direction d, a unit vector from the light. along_u, along_v: as in
 * GRADUS_PICTURE_FIELDS; ahead: the cosine of d to the light's axis. */
GRADUS_FN texture_point point_of_picture(vec3 along_u, vec3 along_v, vec3 d, real ahead) {
    const real inverse = R(1) / r_max(ahead, R(1e-6));
    texture_point point;
    point.u = R(0.5) + v3_dot(along_u, d) * inverse;
    point.v = R(0.5) + v3_dot(along_v, v3_after(d, point.u)) * inverse;
    point.triangle = 0u;
    point.second = R(0);
    point.third = R(0);
#if TRAIT_INDEXED || !defined(__OPENCL_VERSION__)
    point.corner_0 = point.corner_1 = point.corner_2 = 0u;
#endif
    return point;
}

/* Intensity of a projector over its irradiance on a plane at distance 1, by a place of the picture: one over the cosine
 * cubed, which is what a plane loses; nothing beside the picture. */
GRADUS_FN real light_projector_profile(texture_point point, real ahead) {
    /* One after the other (kernels/lib/ordered.h). */
    const real across = r_abs(point.u - R(0.5)), down = r_abs(r_after(point.v, across) - R(0.5));
    const int is_inside = (ahead > R(1e-6)) & (across <= R(0.5)) & (down <= R(0.5));
    const real inverse = R(1) / r_max(ahead, R(1e-6));
    return is_inside ? inverse * inverse * inverse : R(0);
}

GRADUS_LIB_END

#endif
#endif
