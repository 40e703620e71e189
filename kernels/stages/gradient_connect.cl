/* gradient_connect: adds the light sampled at the first or second vertex to a base path and to its differences, by who
 * sees the light. Who does not see it has contribution zero there, and BSDF sampling does not find it; light sampling
 * still does, so this is no failure of the shift.
 *
 * FIRST: each offset path has a connection of its own. Else all end in the base's vertex and share one. */
#include "kernels/lib/weighted_difference.h"
#include "kernels/shared/stage.h"

STAGE gradient_connect(uint count, uint first, uint capacity, uint slots, __global const real *vertex,
                       __global const real *shadow, __global const real *gain, __global real *prefix,
                       __global real *difference
#if FIRST
                       ,
                       __global const real *link, uint link_first, uint link_stride
#endif
) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint slot = AT_UINT(vertex, slot, row);
    const real seen = AT_UINT(shadow, open, row) ? R(1) : R(0);
    const rgb base = rgb_scale(AT_RGB(shadow, value, row), seen);
    const real base_bsdf = seen * AT(gain, base_bsdf, row);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_bsdf));
    ADD_RGB(prefix, value, slot, alone);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const real offset_light = AT(gain, offset_light, at);
#if FIRST
        const real offset_seen = AT_UINT(link, open, link_first + (size_t)j * link_stride + row) ? R(1) : R(0);
#else
        const real offset_seen = seen;
#endif
        const rgb offset = rgb_scale(AT_RGB(gain, value, at), offset_seen);
        const rgb change = weighted_difference(base, offset, base_bsdf,
                                               offset_light + offset_seen * AT(gain, offset_bsdf, at), offset_light);
        const size_t to = (size_t)j * slots + slot;
        ADD_RGB(difference, value, to, change);
    }
}
