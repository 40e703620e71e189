/* Light paths that leave a vertex in another direction than they did. */
#ifndef GRADUS_LIB_LIGHT_VERTEX_LEAVE_H
#define GRADUS_LIB_LIGHT_VERTEX_LEAVE_H
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC TRAIT_TEXTURED TRAIT_TEXTURED_NORMALS
#include "kernels/lib/bsdf.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/light_beam.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/light_vertex.h"
#include "kernels/shared/stage.h"

#define VERTEX_REAL(field) FIELD_OF(light_vertex, light_vertices, record, field)
#define VERTEX_V3(field) FIELD_V3(light_vertex, light_vertices, record, field)

/* What the kind of vertex needs beside its records. */
#if LAST_IS_LIGHT && LIGHTS_HAVE_BEAMS
#define LEAVE_PARAMETERS , __global const real *lights, __global const uint *light_kinds LIGHT_TEXTURE_PARAMETERS
#define LEAVE_ARGUMENTS , lights, light_kinds LIGHT_TEXTURE_ARGUMENTS
#elif LAST_IS_LIGHT
#define LEAVE_PARAMETERS
#define LEAVE_ARGUMENTS
#else
#define LEAVE_PARAMETERS LIGHT_VERTEX_TEXTURES_ARGUMENT
#define LEAVE_ARGUMENTS LIGHT_VERTEX_TEXTURES
#endif

/* By solid angle at the vertex, over the density of the direction that the path took. */
typedef struct {
    rgb power; /* in the new direction; Russian roulette is that of the path */
    real pdf;
    int is_possible; /* and the way back, where the same is asked with the directions exchanged */
    GRADUS_NOT_IN_REGISTERS
} light_leaving;

/* direction: the one that it took; towards: the new one; unit vectors, world frame. Of a vertex of the kind BSDF, or,
 * with LAST_IS_LIGHT, of one on a light; at infinity both directions are the same, and densities are by area across it.
 */
GRADUS_FN light_leaving light_vertex_leave(GRADUS_GLOBAL const real *light_vertices,
                                           GRADUS_GLOBAL const uint *light_vertex_marks,
                                           GRADUS_GLOBAL const real *materials, uint record, uint unit, vec3 direction,
                                           vec3 towards LEAVE_PARAMETERS) {
    const vec3 geometric = VERTEX_V3(geometric);
    const real cosine = v3_dot(geometric, direction), cosine_offset = v3_dot(geometric, towards);
    const uint marked = FIELD_OF(light_vertex_mark, light_vertex_marks, record, material);
    real turned = R(1);
#if LAST_IS_LIGHT
    (void)materials;
    const int is_surface = marked == light_vertex_on_surface, is_far = marked == light_vertex_at_infinity;
    const int same_side = !is_surface | ((cosine > R(0)) & (cosine_offset > R(0)));
    bsdf_value f;
    f.pdf = is_far ? R(1) : GRADUS_INV_PI * (is_surface ? cosine_offset : R(0.25));
    f.value = rgb_gray(f.pdf);
#if LIGHTS_HAVE_BEAMS
    const uint light = FIELD_OF(light_vertex_mark, light_vertex_marks, record, primitive);
    const int is_beam = marked == light_vertex_of_beam;
    const light_beam beam =
        light_beam_towards(lights, light_kinds, is_beam ? light : 0u, unit, towards LIGHT_TEXTURE_ARGUMENTS);
    f.pdf = is_beam ? beam.pdf : f.pdf;
    f.value = rgb_select(is_beam, beam.intensity, f.value);
#endif
#else
    const int same_side = cosine * cosine_offset > R(0);
#if TRAIT_TEXTURED
    const material m = material_with_textures(material_load(materials, marked, unit), light_vertex_textures, unit,
                                              record * (uint)textured_columns);
#else
    const material m = material_load(materials, marked, unit);
#endif
#if TRAIT_SHADING_NORMALS || TRAIT_ANISOTROPIC
    const vec3 shading = VERTEX_V3(shading);
#else
    const vec3 shading = geometric;
#endif
#if TRAIT_ANISOTROPIC
    const vec3 along = VERTEX_V3(along);
#else
    const vec3 along = v3(R(0), R(0), R(0));
#endif
#if TRAIT_TEXTURED_NORMALS
    /* Who looks is where the path goes, and it chose between two normals before it knew (scatter.cl). */
    const mapped_normal map = mapped_normal_at(light_vertex_textures, unit, record * (size_t)textured_columns);
    const bsdf_frame place = bsdf_frame_seen(map, shading, along, towards, m);
    const real turned_chance = mapped_normal_turned_chance(map, shading);
    const real of_side = mapped_normal_turns(map, shading, towards) ? turned_chance : R(1) - turned_chance;
    const real chance = mapped_normal_lets_leave(map, shading, towards) ? of_side : R(0);
#else
    const bsdf_frame place = bsdf_frame_of(surface_frame(shading, along, m));
    const real chance = R(1);
#endif
    const vec3 back = VERTEX_V3(wi);
    const vec3 wi = frame_to_local(place.axes, back), wo = frame_to_local(place.axes, towards);
#if BSDF_IS_DIRAC
    bsdf_value f = bsdf_value_none();
    (void)wi, (void)wo;
#else
    bsdf_value f = MAPPED_VALUE(place, PASTE(BSDF, _evaluate)(m, wi, wo, transport_importance), wi);
#endif
    f.pdf *= chance;
#if TRAIT_SHADING_NORMALS || TRAIT_TEXTURED_NORMALS
    /* As light paths are (scatter.cl). */
    turned = r_abs(wi.z * cosine_offset) / r_max(r_abs(v3_dot(geometric, back) * wo.z), R(1e-12));
#endif
#endif
    light_leaving leaving;
    const real inverse_pdf = R(1) / r_max(VERTEX_REAL(pdf), R(1e-30));
    const rgb arriving = FIELD_RGB(light_vertex, light_vertices, record, power);
    leaving.power =
        rgb_scale(rgb_mul(arriving, f.value), inverse_pdf * turned / r_max(VERTEX_REAL(survival), R(1e-30)));
    leaving.pdf = f.pdf * inverse_pdf;
    /* As paths go on there: what scatters red alone has none of green light. */
    leaving.is_possible = same_side & (f.pdf > R(0)) & (rgb_max(leaving.power) > R(0));
    return leaving;
}

#endif
