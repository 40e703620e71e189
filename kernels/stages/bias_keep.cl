/* bias_keep: adds what the radius does to a pass, by slot, to the pixels: slot 0 is that of pixel `first_pixel`.
 * `half_number`: 0 in even passes and 1 in odd ones, which are kept apart (methods/photons/radius_bias.h). */
#include "kernels/lib/vector.h"
#include "kernels/shared/stage.h"

STAGE bias_keep(uint count, uint slots, uint pixels, uint first_pixel, uint half_number, __global const real *slot_bias,
                __global real *radius_bias) {
    const size_t slot = work_item();
    if (slot >= count)
        return;
    const size_t to = (size_t)half_number * pixels + first_pixel + slot;
    SET_RGB(radius_bias, value, to, rgb_add(AT_RGB(radius_bias, value, to), AT_RGB(slot_bias, value, slot)));
}
