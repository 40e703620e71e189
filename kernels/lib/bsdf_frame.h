/* The frame in which a BSDF stands at a vertex, and what goes with it where a texture has turned the normal. Without
 * TRAIT_TEXTURED_NORMALS it is surface_frame() and nothing else. */
#ifndef GRADUS_LIB_BSDF_FRAME_H
#define GRADUS_LIB_BSDF_FRAME_H
//! traits: TRAIT_TEXTURED_NORMALS TRAIT_ANISOTROPIC
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"

#if TRAIT_TEXTURED_NORMALS
#include "kernels/lib/mapped_normal.h"

GRADUS_LIB_BEGIN

typedef struct {
    frame axes;
    vec3 own; /* the surface's own normal in these axes */
    uint flags;
} bsdf_frame;

/* The map in a row of textured columns. */
GRADUS_FN mapped_normal mapped_normal_at(GRADUS_GLOBAL const real *columns, size_t rows, size_t row) {
    mapped_normal map;
    map.normal = v3(columns[(size_t)textured_normal_x * rows + row], columns[(size_t)textured_normal_y * rows + row],
                    columns[(size_t)textured_normal_z * rows + row]);
    map.flags = (uint)(int)columns[(size_t)textured_normal_flags * rows + row];
    return map;
}

/* Around the normal `seen`, tangent to dp/du within the surface where the material is anisotropic. */
GRADUS_FN bsdf_frame bsdf_frame_around(vec3 seen, vec3 own, vec3 along, uint flags, material m) {
    bsdf_frame place;
#if TRAIT_ANISOTROPIC
    along = v3_mad(along, -v3_dot(own, along), own);
#endif
    place.axes = surface_frame(seen, along, m);
    place.own = frame_to_local(place.axes, own);
    place.flags = flags;
    return place;
}

/* Seen along -wi. */
GRADUS_FN bsdf_frame bsdf_frame_seen(mapped_normal map, vec3 own, vec3 along, vec3 wi, material m) {
    return bsdf_frame_around(mapped_normal_seen(map, own, wi), own, along, map.flags, m);
}

GRADUS_FN bsdf_value mapped_value(bsdf_frame place, bsdf_value value, vec3 wo) {
    const real factor = mapped_factor(place.flags, place.own, wo);
    value.value = rgb_scale(value.value, factor);
    value.pdf = factor > R(0) ? value.pdf : R(0);
    value.pdf_reverse = factor > R(0) ? value.pdf_reverse : R(0);
    return value;
}

GRADUS_FN bsdf_sample mapped_sample(bsdf_sample sample, real factor) {
    sample.weight = rgb_scale(sample.weight, factor);
    sample.pdf = factor > R(0) ? sample.pdf : R(0);
    sample.pdf_reverse = factor > R(0) ? sample.pdf_reverse : R(0);
    return sample;
}

GRADUS_LIB_END

/* At a hit that the stage `material` has read in row `row` of `surface`, seen along -wi. */
#define HIT_FRAME(point, m, wi, rows, row)                                                                             \
    bsdf_frame_seen(mapped_normal_at(surface, rows, row), (point).shading, (point).along, wi, m)
/* At a row of a table of vertices. */
#if TRAIT_ANISOTROPIC
#define VERTEX_ALONG(table, row) AT_V3(table, along, row)
#else
#define VERTEX_ALONG(table, row) v3(R(0), R(0), R(0))
#endif
#define BSDF_FRAME(table, row, m, wi)                                                                                  \
    bsdf_frame_seen(mapped_normal_at(TEXTURED_PART(table), ROWS_OF_##table, row), VERTEX_NORMAL(table, row),           \
                    VERTEX_ALONG(table, row), wi, m)
/* A value or a sample in that frame, of light from wo. */
#define MAPPED_VALUE(place, value, wo) mapped_value(place, value, wo)
#define MAPPED_SAMPLE(place, sample) mapped_sample(sample, mapped_factor((place).flags, (place).own, (sample).wo))

#else

GRADUS_LIB_BEGIN

typedef struct {
    frame axes;
} bsdf_frame;

GRADUS_FN bsdf_frame bsdf_frame_of(frame axes) {
    bsdf_frame place;
    place.axes = axes;
    return place;
}

GRADUS_LIB_END

#define HIT_FRAME(point, m, wi, rows, row) bsdf_frame_of(surface_frame((point).shading, (point).along, m))
#define BSDF_FRAME(table, row, m, wi) bsdf_frame_of(VERTEX_FRAME(table, row, m))
#define MAPPED_VALUE(place, value, wo) value
#define MAPPED_SAMPLE(place, sample) sample

#endif

#endif
