/* gradient_gather: the primal sample and the four differences of each base path, by slot: from what its photons and
 * those moved to its offset paths brought, and from the light that base and offset paths found themselves.
 *
 * Offset paths are made of the base path's random numbers, so all of them have the same density, and the light that
 * they find needs no other weight than one half. TRAIT_ONLY_CHAINS: it does not count. */
//! traits: TRAIT_ONLY_CHAINS
#include "kernels/shared/stage.h"

STAGE gradient_gather(uint count, uint gather_rows, uint slots, uint strip_pixels, real flux_scale,
                      __global const real *gather, __global real *radiance, __global real *prefix,
                      __global real *difference) {
    const size_t slot = work_item();
    if (slot >= count)
        return;
    const real distance = AT(gather, radius, slot);
    const int is_there = distance > R(0);
    const real scale = flux_scale / (is_there ? distance * distance : R(1));
    const rgb photons = rgb_scale(rgb_mul(AT_RGB(gather, throughput, slot), AT_RGB(gather, sum, slot)), scale);
    const real finds = TRAIT_ONLY_CHAINS ? R(0) : R(1);
    const rgb found = rgb_scale(AT_RGB(radiance, value, slot), finds);
    const rgb primal = rgb_select(is_there, rgb_add(found, photons), found);
    SET_RGB(prefix, value, slot, primal);
    SET_RGB(prefix, throughput, slot, rgb_gray(R(0)));
    SET_RGB(radiance, value, slot, rgb_gray(R(0)));
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t to = (size_t)j * slots + slot, at = slot + (size_t)(j + 1u) * strip_pixels;
        const real share = AT(gather, radius, at) < R(0) ? R(0) : R(0.5); /* there is no neighbour */
        const rgb change = rgb_scale(rgb_sub(rgb_scale(AT_RGB(radiance, value, at), finds), found), share);
        const rgb sum = rgb_add(rgb_scale(AT_RGB(difference, value, to), flux_scale), change);
        SET_RGB(difference, value, to, sum);
        AT(difference, ratio, to) = shift_absent;
    }
}
