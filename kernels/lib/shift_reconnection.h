/* The reconnection shift: the offset path goes on to the base path's next vertex (Kettunen et al. 2015). */
#ifndef GRADUS_LIB_SHIFT_RECONNECTION_H
#define GRADUS_LIB_SHIFT_RECONNECTION_H
#include "kernels/lib/ordered.h"
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* Cosines at the target below this fail: float does not know them. */
#define GRADUS_RECONNECTION_GRAZING R(1e-6)

/* |d omega_offset / d omega_base|, by solid angle at offset and at base, where omega_base = base -> target,
 * omega_offset = offset -> target and the target moves on its surface. With theta against the target's normal,
 *     d omega = |cos theta| / distance^2 dA   at either end,
 * so the value is |cos theta_offset| / |cos theta_base| |base - target|^2 / |offset - target|^2.
 *
 * Positions in one frame and unit; target_normal: geometric, unit length, either side. 0, the shift fails, where a
 * distance is below 1e-15, both differ by more than 1e15 times, or a cosine is below GRADUS_RECONNECTION_GRAZING: the
 * same for the shift back. Visibility, and sides that change, are the caller's. For a target at infinity the direction
 * is copied and the Jacobian is 1: do not call this. */
GRADUS_FN real reconnection_jacobian(vec3 base, vec3 offset, vec3 target, vec3 target_normal) {
    const real tiny = R(1e-15);
    const vec3 from_base = v3_sub(target, base);
    const real base_distance = r_sqrt(v3_length_squared(from_base));
    const real inverse_base = R(1) / r_max(base_distance, tiny);
    const real base_cosine = r_abs(v3_dot(from_base, target_normal)) * inverse_base;
    /* The like computation, one after the other. */
    vec3 start = offset;
    start.x = r_after(offset.x, base_cosine);
    const vec3 from_offset = v3_sub(target, v3_ordered(start));
    const real offset_distance = r_sqrt(v3_length_squared(from_offset));
    const real inverse_offset = R(1) / r_max(offset_distance, tiny);
    const real offset_cosine = r_abs(v3_dot(from_offset, target_normal)) * inverse_offset;
    /* Never a product of distances: it would leave float's range. */
    const real ratio = base_distance * inverse_offset, inverse_ratio = offset_distance * inverse_base;
    const int is_valid = (base_distance > tiny) & (offset_distance > tiny) & (ratio < R(1e15)) &
                         (inverse_ratio < R(1e15)) & (base_cosine > GRADUS_RECONNECTION_GRAZING) &
                         (offset_cosine > GRADUS_RECONNECTION_GRAZING);
    const real jacobian = offset_cosine / r_max(base_cosine, GRADUS_RECONNECTION_GRAZING) * ratio * ratio;
    return is_valid ? jacobian : R(0);
}

GRADUS_LIB_END
#endif
