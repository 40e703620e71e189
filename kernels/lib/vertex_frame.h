/* A vertex of a path in the columns of a table (GRADUS_SURFACE_VERTEX_COLUMNS), and its local frame: shading normal,
 * and dp/du where a surface is anisotropic. */
#ifndef GRADUS_LIB_VERTEX_FRAME_H
#define GRADUS_LIB_VERTEX_FRAME_H
//! traits: TRAIT_ANISOTROPIC TRAIT_SHADING_NORMALS
#include "kernels/lib/frame.h"
#include "kernels/shared/material.h"

GRADUS_LIB_BEGIN

/* Gram-Schmidt on dp/du where `anisotropic`; else, and where it is zero or along the normal, any tangent does. */
GRADUS_FN frame frame_from_tangent(vec3 normal, vec3 along, int anisotropic) {
    const frame fallback = frame_from_normal(normal);
    const vec3 s = v3_mad(along, -v3_dot(normal, along), normal);
    const real length_squared = v3_dot(s, s);
    const int usable = anisotropic && length_squared > R(1e-12) * v3_dot(along, along);
    const real inverse = R(1) / r_sqrt(usable ? length_squared : R(1));
    frame f;
    f.s = v3_select(usable, v3_scale(s, inverse), fallback.s);
    f.t = v3_select(usable, v3_cross(normal, f.s), fallback.t);
    f.n = normal;
    return f;
}

/* The frame of a surface of material m; `along` is read only with TRAIT_ANISOTROPIC. */
GRADUS_FN frame surface_frame(vec3 shading, vec3 along, material m) {
    (void)along, (void)m;
#if TRAIT_ANISOTROPIC
    return frame_from_tangent(shading, along, m.alpha_u != m.alpha_v);
#else
    return frame_from_normal(shading);
#endif
}

#if TRAIT_SHADING_NORMALS
#define VERTEX_NORMAL(table, row) AT_V3(table, shading, row)
#define SET_VERTEX_NORMAL(table, row, normal) SET_V3(table, shading, row, normal);
#else
#define VERTEX_NORMAL(table, row) AT_V3(table, geometric, row)
#define SET_VERTEX_NORMAL(table, row, normal)
#endif
#if TRAIT_ANISOTROPIC
#define VERTEX_FRAME(table, row, m) surface_frame(VERTEX_NORMAL(table, row), AT_V3(table, along, row), m)
#define SET_VERTEX_ALONG(table, row, vector) SET_V3(table, along, row, vector);
#else
#define VERTEX_FRAME(table, row, m) frame_from_normal(VERTEX_NORMAL(table, row))
#define SET_VERTEX_ALONG(table, row, vector)
#endif

/* Leaves a surface_point (kernels/lib/surface_point.h), reached along `towards`, in a row of a table of vertices. */
#define SET_SURFACE_VERTEX(table, row, kind_value, point, towards)                                                     \
    AT_UINT(table, kind, row) = kind_value;                                                                            \
    AT_UINT(table, material, row) = (point).material;                                                                  \
    SET_V3(table, position, row, (point).position);                                                                    \
    AT(table, offset, row) = (point).offset;                                                                           \
    SET_V3(table, wi, row, v3_neg(towards));                                                                           \
    SET_V3(table, geometric, row, (point).geometric);                                                                  \
    SET_VERTEX_NORMAL(table, row, (point).shading)                                                                     \
    SET_VERTEX_ALONG(table, row, (point).along)

GRADUS_LIB_END
#endif
