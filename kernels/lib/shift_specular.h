/* The shift at two Dirac vertices: the offset path is mirrored or refracted as the base path is. */
#ifndef GRADUS_LIB_SHIFT_SPECULAR_H
#define GRADUS_LIB_SHIFT_SPECULAR_H
#include "kernels/lib/fresnel.h"
#include "kernels/lib/shift_half_vector.h"

GRADUS_LIB_BEGIN

/* The half-vector copy where the normal of both is the surface's own (Kettunen et al. 2015): wo as dielectric_sample
 * gives it. The Jacobian is 1, in the discrete measure of both vertices.
 *
 * Frames, directions and ior as in shift_half_vector.h. wo_base says which event it was and nothing else. An index
 * ratio of 1 lets the ray pass straight through. Fails, in both directions alike, where wi_base and wi_offset are on
 * different sides, a direction lies in the surface, or the offset is totally reflected where the base refracts. */
GRADUS_FN shifted_direction shift_specular(vec3 wi_base, vec3 wo_base, vec3 wi_offset, real ior_offset) {
    const real side = r_copysign1(wi_base.z);
    const int is_reflected = wo_base.z * side > R(0);
    const real eta = shift_eta(ior_offset, side);
    const real inverse_eta = R(1) / eta;
    const real cosine = wi_offset.z * side;
    const real cosine_transmitted = fresnel_dielectric(r_clamp(cosine, R(0), R(1)), eta).cosine_transmitted;
    const real along_scale = is_reflected ? R(-1) : -inverse_eta;
    const vec3 wo = v3(along_scale * wi_offset.x, along_scale * wi_offset.y,
                       is_reflected ? wi_offset.z : -side * cosine_transmitted);
    const int is_refraction_valid = shift_ior_is_valid(ior_offset) & (cosine_transmitted > R(0));
    const int is_valid =
        (wi_base.z != R(0)) & (wo_base.z != R(0)) & (cosine > R(0)) & (is_reflected | is_refraction_valid);
    return shift_checked(wo, R(1), is_valid);
}

GRADUS_LIB_END
#endif
