/* How light leaves a light: a ray chosen by the light's own distribution, and the flux that it stands for: radiance
 * times cosine over the density of choosing the ray, which is by area and solid angle; by solid angle for points; by
 * area across the direction for lights at infinity, whose rays start from a disk as wide as a sphere that holds the
 * scene, and outside it (Jensen 1996). For all of them the density is that of the light but for a factor, so the flux
 * is the light's whole power, in watts, whichever ray is chosen. */
#ifndef GRADUS_LIB_LIGHT_EMISSION_H
#define GRADUS_LIB_LIGHT_EMISSION_H
//! traits: TRAIT_LIGHT_TRIANGLE TRAIT_LIGHT_SPHERE TRAIT_LIGHT_POINT TRAIT_LIGHT_DIRECTIONAL TRAIT_LIGHT_CONSTANT
//! traits: TRAIT_LIGHT_ENVIRONMENT TRAIT_LIGHT_SPOT
#include "kernels/lib/light_sampling.h"
#include "kernels/shared/light_vertex.h"

GRADUS_LIB_BEGIN

typedef struct {
    vec3 origin;    /* already moved off the surface */
    vec3 direction; /* unit vector */
    rgb power;
    vec3 normal; /* of the surface, on the side that emits; at infinity the direction; 0 for points */
    uint starts; /* light_vertex_on_surface and so on */
    /* The light and, over the probability of choosing it, its value; known when one was chosen. */
    uint light;
    rgb value;
    GRADUS_NOT_IN_REGISTERS
} light_emission;

/* Leaves a surface that emits the same radiance everywhere and in all directions of its front. */
GRADUS_FN light_emission emission_from_surface(rgb radiance, vec3 point, vec3 normal, real area, real offset, real u1,
                                               real u2) {
    light_emission e;
    e.direction = v3_normalize(frame_to_world(frame_from_normal(normal), warp_cosine_hemisphere(u1, u2)));
    e.origin = v3_mad(point, offset_at(point, normal, offset), normal);
    e.power = rgb_scale(radiance, GRADUS_PI * area);
    e.normal = normal;
    e.starts = light_vertex_on_surface;
    return e;
}

/* place: where on the light; leaving: the direction. */
GRADUS_FN light_emission emission_from_triangle(rgb radiance, vec3 p0, vec3 e1, vec3 e2, real offset, point2 place,
                                                point2 leaving) {
    const point2 b = warp_uniform_triangle(place.x, place.y);
    const vec3 parallelogram = v3_cross(e1, e2);
    const real length = r_sqrt(v3_dot(parallelogram, parallelogram));
    const vec3 normal = v3_scale(parallelogram, R(1) / r_max(length, R(1e-30)));
    const vec3 point = v3_mad(v3_mad(p0, b.x, e1), b.y, e2);
    return emission_from_surface(radiance, point, normal, R(0.5) * length, offset, leaving.x, leaving.y);
}

/* facing is 1 or -1. */
GRADUS_FN light_emission emission_from_sphere(rgb radiance, vec3 center, real radius, real facing, real offset,
                                              point2 place, point2 leaving) {
    const vec3 outward = warp_uniform_sphere(place.x, place.y);
    return emission_from_surface(radiance, v3_mad(center, radius, outward), v3_scale(outward, facing),
                                 R(4) * GRADUS_PI * radius * radius, offset, leaving.x, leaving.y);
}

/* Where a ray from a point starts, which may lie in a surface: ahead of it. */
GRADUS_FN vec3 origin_at_point(vec3 point, vec3 direction, real offset) {
    return v3_mad(point, offset_at(point, direction, offset), direction);
}

GRADUS_FN light_emission emission_from_point(rgb intensity, vec3 point, real offset, point2 leaving) {
    light_emission e;
    e.direction = warp_uniform_sphere(leaving.x, leaving.y);
    e.origin = origin_at_point(point, e.direction, offset);
    e.power = rgb_scale(intensity, R(4) * GRADUS_PI);
    e.normal = v3(R(0), R(0), R(0));
    e.starts = light_vertex_at_point;
    return e;
}

/* A ray that comes from the direction `towards`, anywhere across the sphere that holds the scene. `irradiance`: what
 * arrives from there on a plane across it. */
GRADUS_FN light_emission emission_from_direction(rgb irradiance, vec3 towards, vec3 center, real radius, point2 place) {
    const point2 disk = warp_uniform_disk(place.x, place.y);
    light_emission e;
    e.direction = v3_neg(towards);
    e.origin = v3_mad(center, radius, frame_to_world(frame_from_normal(towards), v3(disk.x, disk.y, R(1))));
    e.power = rgb_scale(irradiance, GRADUS_PI * radius * radius);
    e.normal = e.direction;
    e.starts = light_vertex_at_infinity;
    return e;
}

/* The constant environment, uniform over the directions. */
GRADUS_FN light_emission emission_from_constant(rgb radiance, vec3 center, real radius, point2 place, point2 leaving) {
    return emission_from_direction(rgb_scale(radiance, R(4) * GRADUS_PI), warp_uniform_sphere(leaving.x, leaving.y),
                                   center, radius, place);
}

/* The environment's map, whose axes are x, y and z in world space, by the density of its directions. */
GRADUS_FN light_emission emission_from_environment(rgb value, vec3 x, vec3 y, vec3 z, vec3 center, real radius,
                                                   point2 on_disk, environment_choice place) {
    const light_choice s = light_from_environment(value, x, y, z, radius, place);
    return emission_from_direction(s.value, s.direction, center, radius, on_disk);
}

/* A spot, uniform over the cone that its cutoff bounds, `one_minus_cosine` deep. */
GRADUS_FN light_emission emission_from_spot(rgb intensity, vec3 point, vec3 axis, real cutoff, real steepness,
                                            real one_minus_cosine, real offset, point2 leaving) {
    light_emission e;
    e.direction = v3_normalize(
        frame_to_world(frame_from_normal(axis), warp_uniform_cone(one_minus_cosine, leaving.x, leaving.y)));
    e.origin = origin_at_point(point, e.direction, offset);
    e.power = rgb_scale(intensity,
                        R(2) * GRADUS_PI * one_minus_cosine * light_spot_falloff(axis, e.direction, cutoff, steepness));
    e.normal = v3(R(0), R(0), R(0));
    e.starts = light_vertex_of_beam;
    return e;
}

#if LIGHTS_HAVE_PROJECTORS || !defined(__OPENCL_VERSION__)
/* A projector, uniform over its picture: what arrives there on a plane at distance 1, which is what the value says,
 * times the picture's size. */
GRADUS_FN light_emission emission_from_projector(rgb irradiance, vec3 point, vec3 axis, vec3 along_u, vec3 along_v,
                                                 real offset, point2 place) {
    /* One axis after the other (kernels/lib/ordered.h). */
    const real u_squared = r_max(v3_dot(along_u, along_u), R(1e-30));
    const vec3 across = v3_mad(axis, (place.x - R(0.5)) / u_squared, along_u);
    const vec3 v = v3_after(along_v, across.x);
    const real v_squared = r_max(v3_dot(v, v), R(1e-30));
    light_emission e;
    e.direction = v3_normalize(v3_mad(across, (place.y - R(0.5)) / v_squared, v));
    e.origin = origin_at_point(point, e.direction, offset);
    e.power = rgb_scale(irradiance, R(1) / r_sqrt(r_max(u_squared * v_squared, R(1e-30))));
    e.normal = v3(R(0), R(0), R(0));
    e.starts = light_vertex_of_beam;
    return e;
}
#endif

GRADUS_FN light_emission light_emission_select(int first, light_emission a, light_emission b) {
    light_emission e;
    e.origin = v3_select(first, a.origin, b.origin);
    e.direction = v3_select(first, a.direction, b.direction);
    e.power = rgb_select(first, a.power, b.power);
    e.normal = v3_select(first, a.normal, b.normal);
    e.starts = first ? a.starts : b.starts;
    return e;
}

#define EMISSION_FIELD(index, field) OF_LIGHT(emissions, index, emission_stride, emission_##field *(size_t)unit)

/* A ray of one of the lights, whose probability its power is divided by. As in light_sampling() every kind that the
 * scene has is computed, and the one chosen is kept. u: choice.a and .b the light, .c and .d the place; leaving.a and
 * .b the direction. */
GRADUS_FN light_emission emission_sampling(GRADUS_GLOBAL const real *lights, GRADUS_GLOBAL const uint *light_kinds,
                                           GRADUS_GLOBAL const real *emissions,
                                           GRADUS_GLOBAL const uint *emission_alias, uint light_count, vec3 center,
                                           real radius, uint unit, random4 choice,
                                           random4 leaving ENVIRONMENT_PARAMETERS LIGHT_TEXTURE_PARAMETERS) {
    (void)light_kinds, (void)center, (void)radius;
    const light_drawn drawn = light_draw(choice.a, choice.b, light_count);
    const uint column = drawn.column;
    const uint light =
        drawn.keeps < EMISSION_FIELD(column, alias_threshold) ? column : OF_LIGHT(emission_alias, column, 1u, 0u);
    const rgb value =
        rgb_scale(rgb3(LIGHT_FIELD(light, value_r), LIGHT_FIELD(light, value_g), LIGHT_FIELD(light, value_b)),
                  R(1) / EMISSION_FIELD(light, probability));
    const vec3 p = LIGHT_V3(light, p);
#if TRAIT_LIGHT_TRIANGLE || TRAIT_LIGHT_SPHERE || TRAIT_LIGHT_ENVIRONMENT || TRAIT_LIGHT_SPOT || LIGHTS_HAVE_PROJECTORS
    const vec3 e1 = LIGHT_V3(light, e1);
#endif
    const real offset = LIGHT_FIELD(light, offset);
    (void)offset;
    const uint kind = KIND_OF_LIGHT(light);
    (void)kind;
    point2 on_light, away;
    on_light.x = choice.c;
    on_light.y = choice.d;
    away.x = leaving.a;
    away.y = leaving.b;
    light_emission e;
    e.origin = p;
    e.direction = v3(R(0), R(0), R(1));
    e.power = rgb_gray(R(0));
    e.normal = e.direction;
    e.starts = light_vertex_of_beam;
#if TRAIT_LIGHT_TRIANGLE
    e = emission_from_triangle(value, p, e1, LIGHT_V3(light, e2), offset, on_light, away);
#endif
#if TRAIT_LIGHT_SPHERE
    e = light_emission_select(IS_LIGHT_KIND(sphere), emission_from_sphere(value, p, e1.x, e1.y, offset, on_light, away),
                              e);
#endif
#if TRAIT_LIGHT_POINT
    e = light_emission_select(IS_LIGHT_KIND(point), emission_from_point(value, p, offset, away), e);
#endif
#if TRAIT_LIGHT_DIRECTIONAL
    e = light_emission_select(IS_LIGHT_KIND(directional), emission_from_direction(value, p, center, radius, on_light),
                              e);
#endif
#if TRAIT_LIGHT_CONSTANT
    e = light_emission_select(IS_LIGHT_KIND(constant), emission_from_constant(value, center, radius, on_light, away),
                              e);
#endif
#if TRAIT_LIGHT_SPOT
    e = light_emission_select(IS_LIGHT_KIND(spot),
                              emission_from_spot(value, p, e1, LIGHT_FIELD(light, e2_x), LIGHT_FIELD(light, e2_y),
                                                 LIGHT_FIELD(light, e2_z), offset, away),
                              e);
#endif
#if TRAIT_LIGHT_ENVIRONMENT
    const environment_choice direction =
        environment_sample(leaving, LIGHT_FIELD(light, inverse_area), unit ENVIRONMENT_ARGUMENTS);
    e = light_emission_select(
        IS_LIGHT_KIND(environment),
        emission_from_environment(value, p, e1, LIGHT_V3(light, e2), center, radius, on_light, direction), e);
#endif
#if LIGHTS_HAVE_PROJECTORS
    e = light_emission_select(
        IS_LIGHT_KIND(projector),
        emission_from_projector(value, p, e1, PICTURE_V3(light, along_u), PICTURE_V3(light, along_v), offset, on_light),
        e);
#endif
#if TRAIT_TEXTURED_LIGHTS
    texture_point place = point_of_sphere(v3(R(0), R(0), R(1)));
#if LIGHTS_HAVE_PICTURES
    place =
        point_of_picture(PICTURE_V3(light, along_u), PICTURE_V3(light, along_v), e.direction, v3_dot(e1, e.direction));
#endif
#if LIGHTS_HAVE_SURFACE_TEXTURES
    /* After what a spot computes alike (kernels/lib/ordered.h). */
    place =
        place_of_light(kind, light, on_light, v3_after(e.normal, e.power.r), e1.y, place, unit LIGHT_TEXTURE_ARGUMENTS);
#endif
    e.power = rgb_mul(
        e.power, light_texture_at(textures, texture_reals, texels, unit, LIGHT_TEXTURE_FIELD(light, texture), place));
#endif
    e.light = light;
    e.value = value;
    return e;
}

GRADUS_LIB_END
#endif
