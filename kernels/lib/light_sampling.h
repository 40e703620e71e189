/* Choosing a light and a point of it, as seen from a vertex, whatever kinds of lights the scene has. */
#ifndef GRADUS_LIB_LIGHT_SAMPLING_H
#define GRADUS_LIB_LIGHT_SAMPLING_H
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_LIGHT_POINT TRAIT_LIGHT_DIRECTIONAL TRAIT_LIGHT_CONSTANT
#include "kernels/lib/light.h"
#include "kernels/lib/random.h"

#define LIGHT_KINDS                                                                                                    \
    (TRAIT_LIGHT_TRIANGLE + TRAIT_LIGHT_SPHERE + TRAIT_LIGHT_POINT + TRAIT_LIGHT_DIRECTIONAL + TRAIT_LIGHT_CONSTANT)
#if LIGHT_KINDS > 1
#define IF_LIGHT(name) if (kind == light_kind_##name)
#define IS_LIGHT(chosen, name, trait) ((trait) && (chosen).kind == light_kind_##name)
#else
#define IF_LIGHT(name)
#define IS_LIGHT(chosen, name, trait) (trait)
#endif

/* Leaves the segment from a vertex at `position` to the chosen light point in `shadow`. */
#define CONNECT_TO_LIGHT(row, position, chosen)                                                                        \
    {                                                                                                                  \
        const vec3 start =                                                                                             \
            ray_origin(position, AT_V3(vertex, geometric, row), AT(vertex, offset, row), (chosen).choice.direction);   \
        const vec3 end = v3_mad(v3_add(position, (chosen).choice.connection),                                          \
                                FIELD_OF(light, lights, (chosen).light, offset), (chosen).choice.normal);              \
        SET_V3(shadow, origin, row, start);                                                                            \
        SET_V3(shadow, direction, row, v3_sub(end, start));                                                            \
    }

GRADUS_LIB_BEGIN

typedef struct {
    light_choice choice;
    uint light, kind;
    real probability; /* of choosing the light */
} chosen_light;

GRADUS_FN chosen_light light_sampling(GRADUS_GLOBAL const real *lights, GRADUS_GLOBAL const uint *light_kinds,
                                      GRADUS_GLOBAL const uint *light_alias, uint light_count, real scene_diameter,
                                      uint unit, vec3 position, random4 u) {
    (void)light_kinds, (void)scene_diameter;
    const uint column = min((uint)(u.a * (real)light_count), light_count - 1u);
    const uint light = u.b < FIELD_OF(light, lights, column, alias_threshold) ? column : light_alias[column];
    const real probability = FIELD_OF(light, lights, light, probability);
    const rgb value = FIELD_RGB(light, lights, light, value);
    const vec3 p = FIELD_V3(light, lights, light, p);
#if TRAIT_LIGHT_TRIANGLE || TRAIT_LIGHT_SPHERE
    const vec3 e1 = FIELD_V3(light, lights, light, e1);
#endif
    uint kind = 0u;
#if LIGHT_KINDS > 1
    kind = light_kinds[light];
#endif

    light_choice s;
    s.direction = v3(R(0), R(0), R(1));
    s.connection = s.direction;
    s.normal = v3(R(0), R(0), R(0));
    s.value = rgb_gray(R(0));
    s.pdf = R(0);
#if TRAIT_LIGHT_TRIANGLE
    IF_LIGHT(triangle)
    s = light_from_triangle(value, p, e1, FIELD_V3(light, lights, light, e2), position, u.c, u.d);
#endif
#if TRAIT_LIGHT_SPHERE
    IF_LIGHT(sphere)
    s = light_from_sphere(value, p, e1.x, e1.y, FIELD_OF(light, lights, light, inverse_area), position, u.c, u.d);
#endif
#if TRAIT_LIGHT_POINT
    IF_LIGHT(point) {
        s.connection = v3_sub(p, position);
        const real inverse_squared = R(1) / r_max(v3_dot(s.connection, s.connection), R(1e-36));
        s.direction = v3_scale(s.connection, r_sqrt(inverse_squared));
        s.value = rgb_scale(value, inverse_squared);
    }
#endif
#if TRAIT_LIGHT_DIRECTIONAL
    IF_LIGHT(directional) {
        s.direction = p;
        s.connection = v3_scale(p, scene_diameter);
        s.value = value;
    }
#endif
#if TRAIT_LIGHT_CONSTANT
    IF_LIGHT(constant) {
        s.direction = warp_uniform_sphere(u.c, u.d);
        s.connection = v3_scale(s.direction, scene_diameter);
        s.pdf = R(0.25) * GRADUS_INV_PI;
        s.value = rgb_scale(value, R(4) * GRADUS_PI);
    }
#endif

    chosen_light chosen;
    chosen.choice = s;
    chosen.light = light;
    chosen.kind = kind;
    chosen.probability = probability;
    return chosen;
}

GRADUS_LIB_END
#endif
