/* Lights that are points and shine into each direction as bright as they like: spots and projectors. */
#ifndef GRADUS_LIB_LIGHT_BEAM_H
#define GRADUS_LIB_LIGHT_BEAM_H
//! traits: TRAIT_LIGHT_SPOT
#include "kernels/lib/light_sampling.h"

#define LIGHTS_HAVE_BEAMS (TRAIT_LIGHT_SPOT || LIGHTS_HAVE_PROJECTORS)

#if LIGHTS_HAVE_BEAMS

GRADUS_LIB_BEGIN

typedef struct {
    rgb intensity; /* over the light's value */
    real pdf;      /* of the light's photons, by solid angle; 0 beside a projector's picture */
    GRADUS_NOT_IN_REGISTERS
} light_beam;

/* What the light, a spot or projector, sends into a direction: a unit vector from it. */
GRADUS_FN light_beam light_beam_towards(GRADUS_GLOBAL const real *lights, GRADUS_GLOBAL const uint *light_kinds,
                                        uint light, uint unit, vec3 direction LIGHT_TEXTURE_PARAMETERS) {
    const vec3 axis = LIGHT_V3(light, e1);
    const uint kind = KIND_OF_LIGHT(light);
    (void)light_kinds, (void)kind;
    light_beam beam;
    real intensity = R(0);
    beam.pdf = R(0);
#if TRAIT_LIGHT_SPOT
    intensity = light_spot_falloff(axis, direction, LIGHT_FIELD(light, e2_x), LIGHT_FIELD(light, e2_y));
    beam.pdf = R(1) / (R(2) * GRADUS_PI * r_max(LIGHT_FIELD(light, e2_z), R(1e-30)));
#endif
#if LIGHTS_HAVE_PICTURES
    const vec3 along_u = PICTURE_V3(light, along_u), along_v = PICTURE_V3(light, along_v);
    const real ahead = v3_dot(axis, direction);
    const texture_point place = point_of_picture(along_u, along_v, direction, ahead);
#endif
#if LIGHTS_HAVE_PROJECTORS
    const real profile = light_projector_profile(place, ahead);
    intensity = IS_LIGHT_KIND(projector) ? profile : intensity;
    /* Uniform over the picture. One axis after the other (kernels/lib/ordered.h). */
    const real u_squared = v3_dot(along_u, along_u);
    const vec3 v = v3_after(along_v, u_squared);
    beam.pdf = IS_LIGHT_KIND(projector) ? profile * r_sqrt(u_squared * v3_dot(v, v)) : beam.pdf;
#endif
    beam.intensity = rgb_gray(intensity);
#if LIGHTS_HAVE_PICTURES
    beam.intensity = rgb_scale(
        light_texture_at(textures, texture_reals, texels, unit, LIGHT_TEXTURE_FIELD(light, texture), place), intensity);
#endif
    return beam;
}

GRADUS_LIB_END

#endif
#endif
