/* accumulate: adds one sample to each of `count` pixels from `first_pixel` on: slots `first_slot` on, or what the
 * samples around add up to (kernels/lib/filter_frame.h). A sample with a NaN or an infinity is left out and counted.
 *
 * Where the spread of the samples is to tell the variance, and not replicates, whose films are many, each adds its
 * squared deviation from the mean of those before, of which the film has had `film_samples_before`.
 *
 * Of features the film has means over the samples of a pixel, of which there are `samples_before` already: sums without
 * corrections would lose what a sample adds, once they are large beside it. One that is left out counts as 0 there. */
//! traits: TRAIT_AOV TRAIT_PART_BITS
#include "kernels/lib/compensated.h"
#include "kernels/lib/filter_frame.h"
#include "kernels/lib/finite.h"
#include "kernels/lib/seen_features.h"
#include "kernels/lib/squared_deviation.h"
#include "kernels/shared/stage.h"

#define ADD(table, column, correction_column, x)                                                                       \
    {                                                                                                                  \
        compensated s;                                                                                                 \
        s.sum = AT(table, column, pixel);                                                                              \
        s.correction = AT(table, correction_column, pixel);                                                            \
        s = compensated_add(s, x);                                                                                     \
        AT(table, column, pixel) = s.sum;                                                                              \
        AT(table, correction_column, pixel) = s.correction;                                                            \
    }

#define ADD_DEVIATION(channel)                                                                                         \
    AT(feature_film, deviation_##channel, pixel) +=                                                                    \
        finite ? squared_deviation(before, value.channel, AT(film, sum_##channel, pixel)) : R(0);

#define ADD_FEATURE(column, x)                                                                                         \
    AT(feature_film, column, pixel) += ((finite ? (x) : R(0)) - AT(feature_film, column, pixel)) * share;

#if HAS_FRAME
#define SAMPLE(column) FILTERED(frame, frame_##column, pixel)
#endif

STAGE accumulate(uint count, uint pixels, uint first_pixel, uint samples_before, uint film_samples_before,
                 __global real *film,
#if HAS_FRAME
                 __global const real *frame, FILTER_ARGUMENTS
#else
                 uint slots, uint first_slot, __global const real *radiance
#endif
#if TRAIT_AOV
                 ,
                 __global real *feature_film
#if !HAS_FRAME
                 ,
                 __global const real *feature
#endif
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t pixel = (size_t)first_pixel + i;
#if HAS_FRAME
    FILTER_TAPS
    rgb value = rgb3(SAMPLE(value_r), SAMPLE(value_g), SAMPLE(value_b));
#else
    const size_t slot = (size_t)first_slot + i;
    rgb value = AT_RGB(radiance, value, slot);
#endif
#if TRAIT_AOV
#if HAS_FRAME
    const rgb albedo = rgb3(SAMPLE(albedo_r), SAMPLE(albedo_g), SAMPLE(albedo_b));
    const vec3 normal = v3(SAMPLE(normal_x), SAMPLE(normal_y), SAMPLE(normal_z));
    const real depth = SAMPLE(depth);
#else
    const rgb albedo = SEEN_ALBEDO(slot);
    const vec3 normal = SEEN_NORMAL(slot);
    const real depth = SEEN_DEPTH(slot);
#endif
#endif
    const int finite = is_finite(value.r) && is_finite(value.g) && is_finite(value.b);
    value = rgb3(finite ? value.r : R(0), finite ? value.g : R(0), finite ? value.b : R(0));
#if TRAIT_AOV && TRAIT_PART_BITS < 2
    const real before = (real)(film_samples_before - AT_UINT(film, rejected, pixel));
    ADD_DEVIATION(r)
    ADD_DEVIATION(g)
    ADD_DEVIATION(b)
#endif
    ADD(film, sum_r, correction_r, value.r)
    ADD(film, sum_g, correction_g, value.g)
    ADD(film, sum_b, correction_b, value.b)
    AT_UINT(film, rejected, pixel) += finite ? 0u : 1u;
#if TRAIT_AOV
    const real share = R(1) / ((real)samples_before + R(1));
    ADD_FEATURE(albedo_r, albedo.r)
    ADD_FEATURE(albedo_g, albedo.g)
    ADD_FEATURE(albedo_b, albedo.b)
    ADD_FEATURE(normal_x, normal.x)
    ADD_FEATURE(normal_y, normal.y)
    ADD_FEATURE(normal_z, normal.z)
    ADD_FEATURE(depth, depth)
#endif
}
