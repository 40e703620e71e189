/* bias_add: what the radius does to the estimate of each gather point, rows `first` on of `gather`, left in its slot of
 * `slot_bias`: twice what all of the disc says less what the inner half of its area says
 * (methods/photons/radius_bias.h). What is not finite is left out. BY_SLOT: gather points are in the rows of their
 * slots, and their radius is 0 where there is none. */
#include "kernels/lib/finite.h"
#include "kernels/shared/stage.h"

STAGE bias_add(uint count, uint first, uint gather_rows, uint slots, real flux_scale, __global const real *gather,
               __global const real *gather_inner, __global real *slot_bias) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const real distance = AT(gather, radius, row);
    const int is_there = distance > R(0);
    const rgb sum = AT_RGB(gather, sum, row);
    /* Where no pair was found nothing has been written to gather_inner. */
    const int is_known = is_there & (rgb_max(sum) > R(0));
    const real scale = R(2) * flux_scale / (is_there ? distance * distance : R(1));
    const rgb inner = rgb_scale(AT_RGB(gather_inner, value, row), R(2));
    const rgb more = rgb_scale(rgb_mul(AT_RGB(gather, throughput, row), rgb_sub(sum, inner)), scale);
#if BY_SLOT
    const uint slot = (uint)row;
#else
    const int slot = AT_ROW(gather, slot, row);
#endif
    const int counts = is_known & is_finite(more.r) & is_finite(more.g) & is_finite(more.b);
    SET_RGB(slot_bias, value, slot, rgb_select(counts, more, rgb_gray(R(0))));
}
