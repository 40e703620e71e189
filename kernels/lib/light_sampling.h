/* Choosing a light and a point of it, as seen from a vertex, whatever kinds of lights the scene has. */
#ifndef GRADUS_LIB_LIGHT_SAMPLING_H
#define GRADUS_LIB_LIGHT_SAMPLING_H
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_LIGHT_POINT TRAIT_LIGHT_DIRECTIONAL TRAIT_LIGHT_CONSTANT
//! traits: TRAIT_LIGHT_ENVIRONMENT TRAIT_LIGHT_SPOT TRAIT_LIGHT_TREE FEW_LIGHTS
#include "kernels/lib/environment.h"
#include "kernels/lib/light.h"
#include "kernels/lib/light_draw.h"
#include "kernels/lib/light_texture.h"
#include "kernels/lib/light_tree.h"
#include "kernels/lib/random.h"

#define LIGHT_KINDS                                                                                                    \
    (TRAIT_LIGHT_TRIANGLE + TRAIT_LIGHT_SPHERE + TRAIT_LIGHT_POINT + TRAIT_LIGHT_DIRECTIONAL + TRAIT_LIGHT_CONSTANT +  \
     TRAIT_LIGHT_ENVIRONMENT + TRAIT_LIGHT_SPOT + LIGHTS_HAVE_PROJECTORS)
#if LIGHT_KINDS > 1
#define KIND_OF_LIGHT(light) OF_LIGHT(light_kinds, light, 1u, 0u)
#define IS_LIGHT_KIND(name) (kind == light_kind_##name)
#define IS_LIGHT(chosen, name, trait) ((trait) && (chosen).kind == light_kind_##name)
#else
#define KIND_OF_LIGHT(light) 0u
#define IS_LIGHT_KIND(name) 1
#define IS_LIGHT(chosen, name, trait) (trait)
#endif

/* `array` at `index` (of `stride` elements each, `at` the first wanted). Where the scene has few lights, FEW_LIGHTS of
 * them, all are loaded once for all work-items and chosen from: the 16 loads of a light's fields from places of their
 * own cost as much as all else of a light sample. */
#define LIGHT_AT(array, n, stride, at) (array)[(size_t)(n) * (stride) + (at)]
#if FEW_LIGHTS == 0
#define OF_LIGHT(array, index, stride, at) LIGHT_AT(array, index, stride, at)
#elif FEW_LIGHTS == 1
#define OF_LIGHT(array, index, stride, at) LIGHT_AT(array, 0u, stride, at)
#else
/* Sums of which all but one are 0, exactly: three choices would become a switch, which PoCL does not vectorise. */
#define LIGHT_IF(array, index, n, stride, at) ((index) == (n)) * LIGHT_AT(array, n, stride, at)
#if FEW_LIGHTS == 2
#define OF_LIGHT(array, index, stride, at)                                                                             \
    (LIGHT_IF(array, index, 0u, stride, at) + LIGHT_IF(array, index, 1u, stride, at))
#elif FEW_LIGHTS == 3
#define OF_LIGHT(array, index, stride, at)                                                                             \
    (LIGHT_IF(array, index, 0u, stride, at) + LIGHT_IF(array, index, 1u, stride, at) +                                 \
     LIGHT_IF(array, index, 2u, stride, at))
#else
#define OF_LIGHT(array, index, stride, at)                                                                             \
    (LIGHT_IF(array, index, 0u, stride, at) + LIGHT_IF(array, index, 1u, stride, at) +                                 \
     LIGHT_IF(array, index, 2u, stride, at) + LIGHT_IF(array, index, 3u, stride, at))
#endif
#endif
/* Something made of all that few lights have, for HAS_ROW (kernels/shared/stage.h). */
#define LIGHT_BITS(n, field) as_uint((float)LIGHT_AT(lights, n, light_stride, light_##field *(size_t)unit))
#define LIGHT_V3_BITS(n, field) LIGHT_BITS(n, field##_x) | LIGHT_BITS(n, field##_y) | LIGHT_BITS(n, field##_z)
#define BITS_OF_LIGHT(n)                                                                                               \
    | LIGHT_BITS(n, alias_threshold) | LIGHT_BITS(n, probability) | LIGHT_BITS(n, value_r) | LIGHT_BITS(n, value_g) |  \
        LIGHT_BITS(n, value_b) | LIGHT_V3_BITS(n, p) | LIGHT_V3_BITS(n, e1) | LIGHT_V3_BITS(n, e2) |                   \
        LIGHT_BITS(n, inverse_area) | LIGHT_BITS(n, offset) | LIGHT_AT(light_kinds, n, 1u, 0u) |                       \
        LIGHT_AT(light_alias, n, 1u, 0u) LIGHT_TEXTURE_BITS(n)
#if LIGHTS_HAVE_PICTURES
#define PICTURE_BITS(n, field)                                                                                         \
    as_uint((float)LIGHT_AT(light_pictures, n, picture_stride, picture_##field *(size_t)unit))
#define PICTURES_BITS(n)                                                                                               \
    | PICTURE_BITS(n, along_u_x) | PICTURE_BITS(n, along_u_y) | PICTURE_BITS(n, along_u_z) |                           \
        PICTURE_BITS(n, along_v_x) | PICTURE_BITS(n, along_v_y) | PICTURE_BITS(n, along_v_z)
#else
#define PICTURES_BITS(n)
#endif
#if TRAIT_TEXTURED_LIGHTS
#define NUMBER_OF_TEXTURE(n, field)                                                                                    \
    LIGHT_AT(light_textures, n, light_texture_stride, light_texture_##field *(size_t)unit)
#define LIGHT_TEXTURE_BITS(n)                                                                                          \
    | NUMBER_OF_TEXTURE(n, texture) | NUMBER_OF_TEXTURE(n, triangle) | NUMBER_OF_TEXTURE(n, sphere) PICTURES_BITS(n)
#else
#define LIGHT_TEXTURE_BITS(n)
#endif
#if FEW_LIGHTS == 0
#define BITS_OF_LIGHTS 0u
#elif FEW_LIGHTS == 1
#define BITS_OF_LIGHTS 0u BITS_OF_LIGHT(0u)
#elif FEW_LIGHTS == 2
#define BITS_OF_LIGHTS 0u BITS_OF_LIGHT(0u) BITS_OF_LIGHT(1u)
#elif FEW_LIGHTS == 3
#define BITS_OF_LIGHTS 0u BITS_OF_LIGHT(0u) BITS_OF_LIGHT(1u) BITS_OF_LIGHT(2u)
#else
#define BITS_OF_LIGHTS 0u BITS_OF_LIGHT(0u) BITS_OF_LIGHT(1u) BITS_OF_LIGHT(2u) BITS_OF_LIGHT(3u)
#endif
#if TRAIT_TEXTURED_LIGHTS
#define BITS_OF_LIGHT_TEXTURES | texture_bits(TRAIT_LIGHT_TEXTURES, 0u, textures, texture_reals, unit)
#else
#define BITS_OF_LIGHT_TEXTURES
#endif
#define LIGHT_FIELD(index, field) OF_LIGHT(lights, index, light_stride, light_##field *(size_t)unit)
#define LIGHT_V3(index, field)                                                                                         \
    v3(LIGHT_FIELD(index, field##_x), LIGHT_FIELD(index, field##_y), LIGHT_FIELD(index, field##_z))

#define LIGHT_TEXTURE_FIELD(index, field)                                                                              \
    OF_LIGHT(light_textures, index, light_texture_stride, light_texture_##field *(size_t)unit)
#define PICTURE_FIELD(index, field) OF_LIGHT(light_pictures, index, picture_stride, picture_##field *(size_t)unit)
#define PICTURE_V3(index, field)                                                                                       \
    v3(PICTURE_FIELD(index, field##_x), PICTURE_FIELD(index, field##_y), PICTURE_FIELD(index, field##_z))

GRADUS_LIB_BEGIN

typedef struct {
    light_choice choice;
    uint light, kind;
    real probability; /* of choosing the light */
#if TRAIT_TEXTURED_LIGHTS
    rgb untextured; /* choice.value without its texture */
#endif
} chosen_light;

/* The environment's map, whose axes are x, y and z in world space. */
GRADUS_FN light_choice light_from_environment(rgb value, vec3 x, vec3 y, vec3 z, real beyond,
                                              environment_choice place) {
    light_choice s;
    /* One component after the other (kernels/lib/ordered.h). */
    vec3 d = place.direction;
    s.direction.x = v3_dot(v3(x.x, y.x, z.x), d);
    d = v3_after(d, s.direction.x);
    s.direction.y = v3_dot(v3(x.y, y.y, z.y), d);
    d = v3_after(d, s.direction.y);
    s.direction.z = v3_dot(v3(x.z, y.z, z.z), d);
    s.connection = v3_scale(s.direction, beyond);
    s.normal = v3(R(0), R(0), R(0));
    s.pdf = place.pdf;
    s.value = rgb_scale(rgb_mul(value, place.radiance), place.pdf > R(0) ? R(1) / place.pdf : R(0));
    return s;
}

#if TRAIT_TEXTURED_LIGHTS
/* Where a point that was chosen on a light lies on its texture: of a triangle by the uniform numbers `chosen`, of a
 * sphere by the normal there, which `facing` (1 or -1) turns outward; `thrown` of lights that are no surfaces. */
GRADUS_FN texture_point place_of_light(uint kind, uint light, point2 chosen, vec3 normal, real facing,
                                       texture_point thrown, uint unit LIGHT_TEXTURE_PARAMETERS) {
    texture_point place = thrown;
#if LIGHTS_HAVE_SURFACE_TEXTURES && TRAIT_LIGHT_SPHERE
    const vec3 outward = v3_scale(normal, facing);
    place = texture_point_select(
        IS_LIGHT_KIND(sphere),
        point_of_sphere(sphere_place(sphere_axes, unit, LIGHT_TEXTURE_FIELD(light, sphere), outward)), place);
#endif
#if LIGHTS_HAVE_SURFACE_TEXTURES && TRAIT_LIGHT_TRIANGLE
    const point2 weights = warp_uniform_triangle(chosen.x, chosen.y);
    place = texture_point_select(
        IS_LIGHT_KIND(triangle),
        point_of_triangle(triangle_uv_of(triangle_texcoords, unit, LIGHT_TEXTURE_FIELD(light, triangle)),
                          LIGHT_TEXTURE_FIELD(light, triangle), weights.x, weights.y),
        place);
#endif
    return place;
}
#endif

/* Which light, where a tree has chosen it: an argument of light_sampling(). */
#if TRAIT_LIGHT_TREE
#define LIGHT_PICKED_PARAMETER , light_picked picked
#define LIGHT_PICKED_ARGUMENT , picked
#else
#define LIGHT_PICKED_PARAMETER
#define LIGHT_PICKED_ARGUMENT
#endif

GRADUS_FN chosen_light
light_sampling(GRADUS_GLOBAL const real *lights, GRADUS_GLOBAL const uint *light_kinds,
               GRADUS_GLOBAL const uint *light_alias, uint light_count, real scene_diameter, uint unit, vec3 position,
               random4 u ENVIRONMENT_PARAMETERS LIGHT_TEXTURE_PARAMETERS LIGHT_PICKED_PARAMETER) {
    (void)light_kinds, (void)scene_diameter;
#if TRAIT_LIGHT_TREE
    (void)light_alias, (void)light_count;
    const uint light = picked.light;
    const real probability = LIGHT_FIELD(light, probability) * picked.path;
#else
    const light_drawn drawn = light_draw(u.a, u.b, light_count);
    const uint column = drawn.column;
    const uint light =
        drawn.keeps < LIGHT_FIELD(column, alias_threshold) ? column : OF_LIGHT(light_alias, column, 1u, 0u);
    const real probability = LIGHT_FIELD(light, probability);
#endif
    const rgb value = rgb3(LIGHT_FIELD(light, value_r), LIGHT_FIELD(light, value_g), LIGHT_FIELD(light, value_b));
    const vec3 p = LIGHT_V3(light, p);
#if TRAIT_LIGHT_TRIANGLE || TRAIT_LIGHT_SPHERE || TRAIT_LIGHT_ENVIRONMENT || TRAIT_LIGHT_SPOT || LIGHTS_HAVE_PROJECTORS
    const vec3 e1 = LIGHT_V3(light, e1);
#endif
    const uint kind = KIND_OF_LIGHT(light);

    /* Every kind that the scene has is computed, and the one chosen is kept: loads behind conditions, and conditions
     * around so much, keep PoCL from vectorising. */
    light_choice s;
    s.direction = v3(R(0), R(0), R(1));
    s.connection = s.direction;
    s.normal = v3(R(0), R(0), R(0));
    s.value = rgb_gray(R(0));
    s.pdf = R(0);
#if TRAIT_LIGHT_TRIANGLE
    s = light_from_triangle(value, p, e1, LIGHT_V3(light, e2), position, u.c, u.d);
#endif
#if TRAIT_LIGHT_SPHERE
    s = light_choice_select(
        IS_LIGHT_KIND(sphere),
        light_from_sphere(value, p, e1.x, e1.y, LIGHT_FIELD(light, inverse_area), position, u.c, u.d), s);
#endif
#if TRAIT_LIGHT_POINT
    s = light_choice_select(IS_LIGHT_KIND(point), light_from_point(value, p, position), s);
#endif
#if TRAIT_LIGHT_DIRECTIONAL
    s = light_choice_select(IS_LIGHT_KIND(directional), light_from_direction(value, p, scene_diameter), s);
#endif
#if TRAIT_LIGHT_CONSTANT
    s = light_choice_select(IS_LIGHT_KIND(constant), light_from_constant(value, scene_diameter, u.c, u.d), s);
#endif
#if TRAIT_LIGHT_SPOT
    s = light_choice_select(IS_LIGHT_KIND(spot),
                            light_from_spot(value, p, e1, LIGHT_FIELD(light, e2_x), LIGHT_FIELD(light, e2_y), position),
                            s);
#endif
#if TRAIT_LIGHT_ENVIRONMENT
    const environment_choice chosen_place =
        environment_sample(u, LIGHT_FIELD(light, inverse_area), unit ENVIRONMENT_ARGUMENTS);
    s = light_choice_select(IS_LIGHT_KIND(environment),
                            light_from_environment(value, p, e1, LIGHT_V3(light, e2), scene_diameter, chosen_place), s);
#endif

    chosen_light chosen;
#if TRAIT_TEXTURED_LIGHTS
    texture_point place = point_of_sphere(v3(R(0), R(0), R(1)));
#if LIGHTS_HAVE_PROJECTORS
    s = light_choice_select(IS_LIGHT_KIND(projector), light_from_point(value, p, position), s);
#endif
#if LIGHTS_HAVE_PICTURES
    const vec3 away = v3_neg(s.direction);
    const real ahead = v3_dot(e1, away);
    place = point_of_picture(PICTURE_V3(light, along_u), PICTURE_V3(light, along_v), away, ahead);
#endif
#if LIGHTS_HAVE_PROJECTORS
    s.value = rgb_scale(s.value, IS_LIGHT_KIND(projector) ? light_projector_profile(place, ahead) : R(1));
#endif
#if LIGHTS_HAVE_SURFACE_TEXTURES
    point2 on_light;
    on_light.x = u.c;
    on_light.y = u.d;
    /* After what a spot computes alike (kernels/lib/ordered.h). */
    place =
        place_of_light(kind, light, on_light, v3_after(s.normal, s.value.r), e1.y, place, unit LIGHT_TEXTURE_ARGUMENTS);
#endif
    chosen.untextured = s.value;
    s.value = rgb_mul(
        s.value, light_texture_at(textures, texture_reals, texels, unit, LIGHT_TEXTURE_FIELD(light, texture), place));
#endif
    chosen.choice = s;
    chosen.light = light;
    chosen.kind = kind;
    chosen.probability = probability;
    return chosen;
}

GRADUS_LIB_END
#endif
