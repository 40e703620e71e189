/* gradient_connect: adds the light sampled at the vertices where offset paths are apart, or have just reconnected, to a
 * base path and to its differences, by who sees the light. Who does not see it has contribution zero there, and BSDF
 * sampling does not find it; light sampling still does, so this is no failure of the shift.
 *
 * APART: offset paths at vertices of their own have connections of their own. JOINED: those that are in the base's
 * vertex share one. FIRST: at first vertices, where the sums begin. */
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

#if FIRST
#define GATHER_RGB SET_RGB
#else
#define GATHER_RGB ADD_RGB
#endif

STAGE gradient_connect(uint count, uint first, uint capacity, uint slots, __global const real *vertex,
                       __global const real *shadow, __global const real *gain, __global real *prefix,
                       __global real *difference
#if APART
                       ,
                       __global const real *link, uint link_first, uint link_stride
#endif
#if APART && JOINED
                       ,
                       __global const real *shifted_old
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint slot = AT_UINT(vertex, slot, row);
    const real seen = AT_UINT(shadow, open, row) ? R(1) : R(0);
    const rgb base = rgb_scale(AT_RGB(shadow, value, row), seen);
    const real base_bsdf = seen * AT(gain, base_bsdf, row);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_bsdf));
    GATHER_RGB(prefix, value, slot, alone);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const real offset_light = AT(gain, offset_light, at);
        real offset_seen = seen;
#if APART
        offset_seen = AT_UINT(link, open, link_first + (size_t)j * link_stride + row) ? R(1) : R(0);
#endif
        rgb mine = base;
        real mine_other = base_bsdf;
#if APART && JOINED
        offset_seen = AT_UINT_IN(shifted_old, shifted, state, at) < shift_reconnected ? offset_seen : seen;
        const int is_split = AT(gain, offset_bsdf, at) < R(0);
        mine = rgb3(is_split ? alone.r : base.r, is_split ? alone.g : base.g, is_split ? alone.b : base.b);
        mine_other = is_split ? R(0) : base_bsdf;
#endif
        const rgb offset = rgb_scale(AT_RGB(gain, value, at), offset_seen);
        const real offset_bsdf = offset_seen * r_max(AT(gain, offset_bsdf, at), R(0));
        const rgb change = weighted_difference(mine, offset, mine_other, offset_light + offset_bsdf, offset_light);
        const size_t to = (size_t)j * slots + slot;
        GATHER_RGB(difference, value, to, change);
    }
}
