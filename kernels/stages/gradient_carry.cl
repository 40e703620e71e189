/* gradient_carry: keeps the differences to the row below of a strip's last row, slots `first_slot` on, by column of the
 * image: the next strip finishes them. */
#include "kernels/shared/stage.h"

STAGE gradient_carry(uint count, uint slots, uint first_slot, uint crop_width, __global const real *difference,
                     __global real *carry) {
    const size_t x = work_item();
    if (x >= count)
        return;
    const rgb below = AT_RGB(difference, value, (size_t)2 * slots + first_slot + x);
    SET_RGB(carry, value, x, below);
}
