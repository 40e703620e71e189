/* connect: adds to each path the light sampled from its newest vertex (rows `first` on), where nothing is in between.
 */
#include "kernels/shared/stage.h"

STAGE connect(uint count, uint first, uint capacity, uint slots, __global const real *path, __global const real *shadow,
              __global real *radiance) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const int slot = AT_ROW(path, slot, row);
    const int open = AT_UINT(shadow, open, row) != 0u;
    AT(radiance, value_r, slot) += open ? AT(shadow, value_r, row) : R(0);
    AT(radiance, value_g, slot) += open ? AT(shadow, value_g, row) : R(0);
    AT(radiance, value_b, slot) += open ? AT(shadow, value_b, row) : R(0);
}
