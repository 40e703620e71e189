/* gradient_frame: keeps the primal samples and the differences of slots `first_slot` on, which are rows of one frame,
 * as those of the pixels from `first_pixel` on: `gradient_accumulate` reads them once those around are there.
 * Differences are between what both pixels give, as there (kernels/stages/gradient_accumulate.cl); that from the pixel
 * above the first row is partly in `carry`, or there is none (`has_above` 0). */
#include "kernels/lib/division.h"
#include "kernels/shared/stage.h"

STAGE gradient_frame(uint count, uint slots, uint pixels, uint first_slot, uint first_pixel, uint has_above,
                     uint width_multiplier, uint width_shift, uint crop_width, __global const real *prefix,
                     __global const real *difference, __global const real *carry, __global real *gradient_frame) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t slot = (size_t)first_slot + i, pixel = (size_t)first_pixel + i;
    const uint row = divide((uint)i, width_multiplier, width_shift), x = (uint)i - row * crop_width;
    const int has_right = x + 1u < crop_width, is_carried = row == 0u, exists_above = !is_carried | (has_above != 0u);
    const size_t right = has_right ? slot + 1u : slot, above = is_carried ? slot : slot - crop_width;
    SET_RGB(gradient_frame, primal, pixel, AT_RGB(prefix, value, slot));
    const rgb to_right = rgb_sub(AT_RGB(difference, value, slot), AT_RGB(difference, value, (size_t)slots + right));
    SET_RGB(gradient_frame, right, pixel, rgb_select(has_right, to_right, rgb_gray(R(0))));
    const rgb from_above =
        rgb_select(is_carried, AT_RGB(carry, value, x), AT_RGB(difference, value, (size_t)2 * slots + above));
    const rgb down = rgb_sub(from_above, AT_RGB(difference, value, (size_t)3 * slots + slot));
    SET_RGB(gradient_frame, above, pixel, rgb_select(exists_above, down, rgb_gray(R(0))));
}
