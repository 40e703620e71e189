/* accumulate: adds one sample to each of `count` pixels from `first_pixel` on: slots `first_slot` on. A sample with a
 * NaN or an infinity is left out and counted. Samples of filters with negative lobes have a weight. Squares are summed
 * where the spread of the samples is to tell the variance: not where replicates do, the films of which are many.
 *
 * With weights the squares are those of deviations from the mean of the samples before in the same film, of which there
 * are film_samples_before, whose weights have the sum weights_before, and their squares squares_before. From plain
 * squares the mean's could not be taken off: what the weights are would be left, times mean and deviation.
 *
 * Of features the film has means over the samples of a pixel, of which there are `samples_before` already: sums without
 * corrections would lose what a sample adds, once they are large beside it. One that is left out counts as 0 there. */
//! traits: TRAIT_AOV TRAIT_LOBE_LEVELS TRAIT_FILTER_SIGNED TRAIT_PART_BITS
#include "kernels/lib/compensated.h"
#include "kernels/lib/filter_weight.h"
#include "kernels/lib/finite.h"
#include "kernels/lib/seen_features.h"
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

#define ADD_FEATURE(column, x)                                                                                         \
    AT(feature_film, column, pixel) += ((finite ? WEIGHTED(x) : R(0)) - AT(feature_film, column, pixel)) * share;

#if TRAIT_FILTER_SIGNED
#define SQUARE(channel)                                                                                                \
    (finite ? weighted_deviation(filter_weight, weights_before * kept, squares_before * kept, value.channel,           \
                                 AT(film, sum_##channel, pixel))                                                       \
            : R(0))
#else
#define SQUARE(channel) (value.channel * value.channel)
#endif

STAGE accumulate(uint count, uint slots, uint pixels, uint first_slot, uint first_pixel, uint samples_before,
                 __global const real *radiance, __global real *film
#if TRAIT_AOV
                 ,
                 __global const real *feature, __global real *feature_film
#endif
#if TRAIT_FILTER_SIGNED
                 ,
                 __global const real *filtered
#if TRAIT_AOV && TRAIT_PART_BITS < 2
                 ,
                 real film_samples_before, real weights_before, real squares_before
#endif
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t slot = (size_t)first_slot + i, pixel = (size_t)first_pixel + i;
    FILTER_WEIGHT(slot)
    rgb value = AT_RGB(radiance, value, slot);
    value = rgb3(WEIGHTED(value.r), WEIGHTED(value.g), WEIGHTED(value.b));
#if TRAIT_AOV
    const real counts = SEEN_WEIGHT(slot);
    const rgb albedo = rgb_scale(AT_RGB(feature, albedo, slot), counts);
    const vec3 normal = v3_scale(AT_V3(feature, normal, slot), counts);
    /* Negative where a path has met mirrors and glass alone. */
    const real depth = r_abs(AT(feature, depth, slot)) * counts;
#endif
    const int finite = is_finite(value.r) && is_finite(value.g) && is_finite(value.b);
    value = rgb3(finite ? value.r : R(0), finite ? value.g : R(0), finite ? value.b : R(0));
#if TRAIT_AOV && TRAIT_PART_BITS < 2
#if TRAIT_FILTER_SIGNED
    /* Samples that were left out weigh nothing, and which ones these were is not known. */
    const real kept = R(1) - (real)AT_UINT(film, rejected, pixel) / r_max(film_samples_before, R(1));
#endif
    ADD(feature_film, square_r, square_correction_r, SQUARE(r))
    ADD(feature_film, square_g, square_correction_g, SQUARE(g))
    ADD(feature_film, square_b, square_correction_b, SQUARE(b))
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
