/* The half-vector copy: the offset path leaves a rough vertex by the base path's microfacet normal, in the local frame
 * of its own vertex (Kettunen et al. 2015, eqs. 11 and 12; supplement, eqs. 19 to 23).
 *
 * Frames and directions as in kernels/lib/bsdf_sample.h, an index ratio (ior) as in material: inside over outside, the
 * normal points outside. With eta = (index on wo's side) / (index on wi's side), 1 for reflection, the normal is
 *     m = +-h / |h|, h = wi + eta wo (Walter et al. 2007, eq. 16), on wi's side of the surface.
 * With c = wi.m, root = |eta wo.m| = sqrt(c^2 + (eta - 1)(eta + 1)) and wi held, by solid angle,
 *     reflection  wo = 2 c m - wi,                                          |d wo / d m| = 4 c,
 *     refraction  wo = -(wi + (eta - 1)(eta + 1) / (c + root) m) / eta,     |d wo / d m| = |h|^2 / (eta root).
 * wo is along m - wi / eta, along = +-|h| / eta: a turn of m by a small e, normal to m, moves wo by along e in the
 * plane normal to m, and an area there is |wo.m| of the solid angle, so that |d wo / d m| = along^2 / |wo.m|. (The
 * supplement's eq. 21 lacks a factor and the line before eq. 22 a square; eqs. 20 and 23 are right, and are these.)
 * The shift's Jacobian, |d wo_offset / d wo_base|, is the offset's |d wo / d m| over the base's. There |h| is taken as
 * |eta^2 - 1| / (c + root), which has no cancellation where eta is near 1. */
#ifndef GRADUS_LIB_SHIFT_HALF_VECTOR_H
#define GRADUS_LIB_SHIFT_HALF_VECTOR_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* The shift fails where a direction's cosine against the microfacet normal is less than these: the way back would not
 * find it again. Refraction needs more: near total reflection root^2 is known to rounding, root to that over root. */
#define GRADUS_HALF_VECTOR_GRAZING_REFLECTED R(1e-3)
#define GRADUS_HALF_VECTOR_GRAZING_REFRACTED R(1e-2)

/* Refraction with a smaller |eta^2 - 1| fails: no half vector. Ratios of 1.0001, where rough dielectrics stop, pass. */
#define GRADUS_HALF_VECTOR_SAME_INDEX R(1e-4)

typedef struct {
    vec3 wo;       /* of the offset path, in the frame of its vertex; 0 where the shift fails */
    real jacobian; /* |d wo_offset / d wo_base|, by solid angle at each vertex; 0 where the shift fails */
    int is_valid;  /* 0: the shift fails, and so would the shift back */
    GRADUS_NOT_IN_REGISTERS
} shifted_direction;

/* Index below over index above, as seen from the given side (+1 or -1). Ratios that shift_ior_is_valid refuses are
 * bounded, so that what follows stays finite. */
GRADUS_FN real shift_eta(real ior, real side) {
    const real bounded = r_clamp(ior, R(0.01), R(100));
    return side > R(0) ? bounded : R(1) / bounded;
}

GRADUS_FN int shift_ior_is_valid(real ior) { return (ior >= R(0.01)) & (ior <= R(100)); }

/* The result, or zeros. */
GRADUS_FN shifted_direction shift_checked(vec3 wo, real jacobian, int is_valid) {
    shifted_direction shifted;
    shifted.wo = v3(is_valid ? wo.x : R(0), is_valid ? wo.y : R(0), is_valid ? wo.z : R(0));
    shifted.jacobian = is_valid ? jacobian : R(0);
    shifted.is_valid = is_valid;
    return shifted;
}

/* Directions are unit vectors. ior_base and ior_offset, in [0.01, 100], are those of the two materials; reflection
 * does not read them. Fails, in both directions alike, where
 * - wi_base and wi_offset are on different sides, or a direction lies in the surface;
 * - the base's pair has no microfacet on wi's side that turns wi into wo;
 * - the offset is totally reflected where the base refracts, or its wo has another side than the base's;
 * - it is refraction with either index ratio too near to 1 (GRADUS_HALF_VECTOR_SAME_INDEX): a ray that passes straight
 *   through has no half vector. shift_specular takes it, where such an interface is smooth;
 * - a direction grazes the microfacet: GRADUS_HALF_VECTOR_GRAZING_REFLECTED and _REFRACTED. */
GRADUS_FN shifted_direction shift_half_vector(vec3 wi_base, vec3 wo_base, real ior_base, vec3 wi_offset,
                                              real ior_offset) {
    /* Turned by a point reflection where the paths come from below: then wi, and the normal, are above. */
    const real side = r_copysign1(wi_base.z);
    const vec3 from_base = v3_scale(wi_base, side), to_base = v3_scale(wo_base, side);
    const vec3 from = v3_scale(wi_offset, side);
    const int is_reflected = to_base.z > R(0);
    const real eta_base = is_reflected ? R(1) : shift_eta(ior_base, side);
    const real contrast_base = (eta_base - R(1)) * (eta_base + R(1));
    const real eta = is_reflected ? R(1) : shift_eta(r_after(ior_offset, contrast_base), side);
    const real contrast = (eta - R(1)) * (eta + R(1));

    const vec3 h = v3_mad(from_base, eta_base, to_base);
    const real h_length = r_sqrt(v3_length_squared(h));
    const vec3 normal = v3_scale(h, r_copysign1(h.z) / r_max(h_length, R(1e-15)));
    /* |h| / 2 for reflection, the same for both directions. */
    const real cosine_base = is_reflected ? R(0.5) * h_length : v3_dot(from_base, normal);
    const real to_cosine_base = is_reflected ? cosine_base : -v3_dot(to_base, normal);

    const real cosine = v3_dot(from, normal);
    const real root_squared = cosine * cosine + contrast;
    const real root = r_sqrt(r_max(root_squared, R(0)));
    const real inverse_eta = R(1) / eta;
    const real root_base = eta_base * to_cosine_base;
    const real sum_base = cosine_base + root_base, sum = r_max(cosine + root, R(1e-3));
    /* wo = along normal - wi / eta */
    const real along = is_reflected ? R(2) * cosine : -contrast * inverse_eta / sum;
    const vec3 to = v3_sub(v3_scale(normal, along), v3_scale(from, inverse_eta));

    const real least = is_reflected ? GRADUS_HALF_VECTOR_GRAZING_REFLECTED : GRADUS_HALF_VECTOR_GRAZING_REFRACTED;
    /* r_after, here and above: base and offset would be packed into short vectors. */
    const int is_index_valid = (r_abs(contrast_base) > GRADUS_HALF_VECTOR_SAME_INDEX) &
                               (r_after(r_abs(contrast), root_base) > GRADUS_HALF_VECTOR_SAME_INDEX) &
                               shift_ior_is_valid(ior_base) & shift_ior_is_valid(ior_offset);
    const int is_base_valid =
        (from_base.z > R(0)) & (to_base.z != R(0)) & (cosine_base > least) & (to_cosine_base > least);
    const int is_offset_valid = (from.z > R(0)) & (to.z != R(0)) & ((to.z > R(0)) == is_reflected) & (cosine > least) &
                                (is_reflected | (root * inverse_eta > least));
    const int is_valid = is_base_valid & is_offset_valid & (is_reflected | is_index_valid);

    /* Bounded, as sum is, where it will be thrown away. */
    const real h_ratio = contrast * sum_base / (is_index_valid ? contrast_base * sum : R(1));
    const real refracted = h_ratio * h_ratio * eta_base * root_base / r_max(eta * root, R(1e-6));
    const real reflected = cosine / r_max(cosine_base, R(1e-3));
    return shift_checked(v3_scale(to, side), is_reflected ? reflected : refracted, is_valid);
}

GRADUS_LIB_END
#endif
