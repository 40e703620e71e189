/* What a ray that leaves the scene sees: the constant environment or the environment's map. */
#ifndef GRADUS_LIB_ESCAPED_LIGHT_H
#define GRADUS_LIB_ESCAPED_LIGHT_H
//! traits: TRAIT_LIGHT_CONSTANT TRAIT_LIGHT_ENVIRONMENT
#include "kernels/lib/environment.h"
#include "kernels/lib/light_found.h"

/* Something made of all that is read of light n, for HAS_ROW (kernels/shared/stage.h). */
#define ESCAPED_FIELD_BITS(n, field) as_uint((float)FIELD_OF(light, lights, n, field))
#define ESCAPED_V3_BITS(n, field)                                                                                      \
    (ESCAPED_FIELD_BITS(n, field##_x) | ESCAPED_FIELD_BITS(n, field##_y) | ESCAPED_FIELD_BITS(n, field##_z))
#define ESCAPED_BITS(n)                                                                                                \
    (ESCAPED_FIELD_BITS(n, probability) | ESCAPED_FIELD_BITS(n, value_r) | ESCAPED_FIELD_BITS(n, value_g) |            \
     ESCAPED_FIELD_BITS(n, value_b) | ESCAPED_FIELD_BITS(n, inverse_area) | ESCAPED_V3_BITS(n, p) |                    \
     ESCAPED_V3_BITS(n, e1) | ESCAPED_V3_BITS(n, e2))

GRADUS_LIB_BEGIN

/* direction: of unit length, in world space. environment_light: the light's number; a black one's where there is no
 * environment. */
GRADUS_FN light_found light_escaped(GRADUS_GLOBAL const real *lights, uint environment_light, uint unit,
                                    vec3 direction ENVIRONMENT_PARAMETERS) {
    const real probability = FIELD_OF(light, lights, environment_light, probability);
    light_found found;
    found.radiance = FIELD_RGB(light, lights, environment_light, value);
    found.pdf = probability * (R(0.25) * GRADUS_INV_PI);
    found.light = environment_light;
#if TRAIT_LIGHT_ENVIRONMENT
    /* One after the other (kernels/lib/ordered.h). */
    vec3 in_map;
    in_map.x = v3_dot(FIELD_V3(light, lights, environment_light, p), direction);
    in_map.y = v3_dot(FIELD_V3(light, lights, environment_light, e1), v3_after(direction, in_map.x));
    in_map.z = v3_dot(FIELD_V3(light, lights, environment_light, e2), v3_after(direction, in_map.y));
    const environment_light_value seen = environment_lookup(
        in_map, FIELD_OF(light, lights, environment_light, inverse_area), unit ENVIRONMENT_ARGUMENTS);
    const rgb through_map = rgb_mul(found.radiance, seen.radiance);
    const int is_map = !TRAIT_LIGHT_CONSTANT || environment_rows > 0u;
    found.radiance = rgb_select(is_map, through_map, found.radiance);
    found.pdf = is_map ? probability * seen.pdf : found.pdf;
#else
    (void)direction;
#endif
    return found;
}

GRADUS_LIB_END
#endif
