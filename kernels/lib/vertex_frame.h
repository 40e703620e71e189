/* The local frame of a path's vertex: shading normal, and dp/du where a surface is anisotropic. */
#ifndef GRADUS_LIB_VERTEX_FRAME_H
#define GRADUS_LIB_VERTEX_FRAME_H
//! traits: TRAIT_ANISOTROPIC TRAIT_SHADING_NORMALS
#include "kernels/lib/frame.h"

GRADUS_LIB_BEGIN

/* Gram-Schmidt on dp/du where `anisotropic`; else, and where it is zero or along the normal, any tangent does. */
GRADUS_FN frame frame_from_tangent(vec3 normal, vec3 along, int anisotropic) {
    const frame fallback = frame_from_normal(normal);
    const vec3 s = v3_mad(along, -v3_dot(normal, along), normal);
    const real length_squared = v3_dot(s, s);
    const int usable = anisotropic && length_squared > R(1e-12) * v3_dot(along, along);
    const real inverse = R(1) / r_sqrt(usable ? length_squared : R(1));
    frame f;
    f.s = v3(usable ? s.x * inverse : fallback.s.x, usable ? s.y * inverse : fallback.s.y,
             usable ? s.z * inverse : fallback.s.z);
    const vec3 t = v3_cross(normal, f.s);
    f.t = v3(usable ? t.x : fallback.t.x, usable ? t.y : fallback.t.y, usable ? t.z : fallback.t.z);
    f.n = normal;
    return f;
}

#if TRAIT_SHADING_NORMALS
#define VERTEX_NORMAL(row) AT_V3(vertex, shading, row)
#else
#define VERTEX_NORMAL(row) AT_V3(vertex, geometric, row)
#endif
#if TRAIT_ANISOTROPIC
#define VERTEX_FRAME(row, m)                                                                                           \
    frame_from_tangent(VERTEX_NORMAL(row), AT_V3(tangent, along, row), (m).alpha_u != (m).alpha_v)
#else
#define VERTEX_FRAME(row, m) frame_from_normal(VERTEX_NORMAL(row))
#endif

GRADUS_LIB_END
#endif
