/* What a normal map or a bump map makes of a surface's normal. */
#ifndef GRADUS_LIB_NORMAL_MAP_H
#define GRADUS_LIB_NORMAL_MAP_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* A surface at a point: unit normals of its front, and how the point moves with (u, v) of textures, in the plane of the
 * shading normal. */
typedef struct {
    vec3 geometric, shading;
    vec3 s, t;               /* unit vectors along dp/du and dp/dv in that plane */
    real length_s, length_t; /* of dp/du and dp/dv there */
    int is_usable;           /* 0 where (u, v) are degenerate: then the normal stays */
} textured_surface;

GRADUS_FN textured_surface textured_surface_at(vec3 geometric, vec3 shading, vec3 along_u, vec3 along_v) {
    textured_surface surface;
    surface.geometric = geometric;
    surface.shading = shading;
    const vec3 s = v3_mad(along_u, -v3_dot(shading, along_u), shading);
    const real s_squared = v3_dot(s, s);
    const vec3 after_s = v3_after(along_v, s_squared);
    const vec3 t = v3_mad(after_s, -v3_dot(shading, after_s), shading);
    const real t_squared = v3_dot(t, t);
    const int has_s = s_squared > R(1e-12) * v3_dot(along_u, along_u);
    const int has_t = t_squared > R(1e-12) * v3_dot(after_s, after_s);
    surface.length_s = r_sqrt(has_s ? s_squared : R(1));
    surface.length_t = r_sqrt(has_t ? t_squared : R(1));
    surface.s = v3_scale(s, R(1) / surface.length_s);
    surface.t = v3_scale(t, R(1) / surface.length_t);
    surface.is_usable = has_s & has_t;
    return surface;
}

/* `vector`, of any length, as a unit vector; the shading normal where it has none or (u, v) are degenerate. */
GRADUS_FN vec3 textured_surface_normal(textured_surface surface, vec3 vector) {
    const real squared = v3_dot(vector, vector);
    const int is_one = surface.is_usable & (squared > R(1e-20));
    return v3_select(is_one, v3_scale(vector, R(1) / r_sqrt(is_one ? squared : R(1))), surface.shading);
}

/* Of a normal map's colour: x along dp/du, y along n x dp/du, z along the normal, each from [-1, 1] to [0, 1]. */
GRADUS_FN vec3 normal_of_color(textured_surface surface, rgb color) {
    const vec3 across = v3_cross(surface.shading, surface.s);
    const real x = R(2) * color.r - R(1), y = R(2) * color.g - R(1), z = R(2) * color.b - R(1);
    const vec3 sum = v3_add(v3_add(v3_scale(surface.s, x), v3_scale(across, y)), v3_scale(surface.shading, z));
    return textured_surface_normal(surface, sum);
}

/* Of a surface moved along its normal by a height, whose derivatives by u and v are these in lengths (Blinn 1978): the
 * change of the normal itself is left out. It faces as the surface does. */
GRADUS_FN vec3 normal_of_height(textured_surface surface, real by_u, real by_v) {
    const vec3 along_u = v3_mad(surface.s, by_u / surface.length_s, surface.shading);
    const vec3 along_v = v3_mad(surface.t, by_v / surface.length_t, surface.shading);
    const vec3 normal = v3_cross(along_u, along_v);
    return textured_surface_normal(surface, v3_scale(normal, r_copysign1(v3_dot(normal, surface.geometric))));
}

/* As `twosided` has it, which mirrors directions that come from behind: seen from there the normal is this. A map
 * around it (is_outside) turns the surface as it is. */
GRADUS_FN vec3 normal_from_behind(vec3 shading, vec3 normal, int is_outside) {
    const vec3 mirrored = v3_mad(normal, R(-2) * v3_dot(shading, normal), shading);
    return v3_select(is_outside, v3_neg(normal), mirrored);
}

GRADUS_LIB_END
#endif
