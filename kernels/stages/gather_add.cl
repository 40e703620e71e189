/* gather_add: adds to each path what was gathered at its gather point, rows `first` on of `gather`: the photons' f
 * power over the area of the disc and the number of light paths, `flux_scale` being 1 / (pi light paths). */
#include "kernels/shared/stage.h"

STAGE gather_add(uint count, uint first, uint gather_rows, uint slots, real flux_scale, __global const real *gather,
                 __global real *radiance) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const real distance = AT(gather, radius, row);
    const real scale = flux_scale / (distance * distance);
    const rgb gained = rgb_scale(rgb_mul(AT_RGB(gather, throughput, row), AT_RGB(gather, sum, row)), scale);
    const int slot = AT_ROW(gather, slot, row);
    ADD_RGB(radiance, value, slot, gained);
}
