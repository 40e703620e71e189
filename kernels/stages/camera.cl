/* camera: begins one path a row. Leaves its first ray, its random key, throughput 1 and radiance 0.
 *
 * Paths take rows `first_row` on and slots `first_slot` on. Samples are numbered pixel first: number = sample * pixels
 * + pixel of the crop; slot 0 is pixel `first_pixel` of sample `first_sample`. Random numbers go by the pixel of the
 * full film, so that a crop equals the same part of the full image.
 *
 * PLANES: gradient-domain photon mapping. Slots come in five planes of `strip_pixels`: the paths of the pixels, then
 * their offset paths, which are those of the neighbours (gradient_neighbour in kernels/lib/gradient.h) with the pixel's
 * own random numbers. */
//! traits: TRAIT_FILTER TRAIT_AOV TRAIT_SHARED_JITTER
//! traits: TRAIT_SHARED_START TRAIT_HIDE_EMITTERS
#include "kernels/lib/additive_sequence.h"
#include "kernels/lib/begin_path.h"
#include "kernels/lib/camera_ray.h"
#include "kernels/lib/division.h"
#include "kernels/lib/filter_table.h"
#include "kernels/lib/path_draw.h"
#include "kernels/lib/sample_number.h"

STAGE camera(uint count, uint unit, uint capacity, uint slots, __global real *ray, __global real *path,
             __global real *radiance, __global const real *camera, uint first_row, uint first_slot, uint first_pixel,
             uint first_sample_low, uint first_sample_high, uint pixels, uint pixels_multiplier, uint pixels_shift,
             uint width_multiplier, uint width_shift, uint crop_x, uint crop_y, uint crop_width, uint film_width,
             uint seed_low, uint seed_high
#if TRAIT_AOV
             ,
             __global real *feature
#endif
#if TRAIT_FILTER
             ,
             __global const real *filter_offsets
#endif
#if PLANES
             ,
             uint strip_pixels, uint strip_multiplier, uint strip_shift, uint crop_height, uint gather_rows,
             __global real *gather, __global real *direct
#endif
) {
    const size_t i = work_item();
    if (!HAS_ROW(i, count, camera_bits(camera, unit)))
        return;
    const size_t row = first_row + i;
    const uint slot = first_slot + (uint)i;
#if PLANES
    const uint plane = divide(slot, strip_multiplier, strip_shift);
    const uint number = first_pixel + slot - plane * strip_pixels;
#else
    const uint number = first_pixel + slot;
#endif
    const uint more_samples = divide(number, pixels_multiplier, pixels_shift);
    const uint pixel = number - more_samples * pixels;
    const sample_place place = sample_place_after(first_sample_low, first_sample_high, more_samples);
    const sample_place sample = sample_number_at(place);
    const uint line = divide(pixel, width_multiplier, width_shift);
    const uint y = line + crop_y;
    const uint x = pixel - line * crop_width + crop_x;

#if TRAIT_STRATIFIED
    random_bits key = random_key(seed_low, seed_high, y * film_width + x, 0u, sample.high);
    key.y = sample.low;
#else
    const random_bits key = random_key(seed_low, seed_high, y * film_width + x, sample.low, sample.high);
#endif
#if TRAIT_SHARED_JITTER
    /* All pixels of a sample share their place within the pixel. TRAIT_SHARED_START: and their point of the lens, so
     * that base and offset paths are each other's first segments; else halves, which are to tell the image's error,
     * have a sequence of their own each. */
    const sample_place shared = TRAIT_SHARED_START ? shared_number_at(place) : sample;
    const random_bits start = random_key(seed_low, seed_high, 0xFFFFFFFFu, 0u, shared.high);
#if TRAIT_STRATIFIED
    /* In a sequence that fills the pixel evenly: what all pixels share does not average out over the image. */
    const point2 jitter = additive_sequence(start.x, start.y, shared.low);
    const random4 lens = stratified_draw(TRAIT_SHARED_START ? start.z : key.x, TRAIT_SHARED_START ? shared.low : key.y,
                                         random_dimension_camera);
    random4 u;
    u.a = jitter.x;
    u.b = jitter.y;
    u.c = lens.a;
    u.d = lens.b;
#else
    random4 u = random_draw(start.x, shared.low, random_dimension_camera);
#if !TRAIT_SHARED_START
    const random4 lens = random_draw(key.x, key.y, random_dimension_camera);
    u.c = lens.a;
    u.d = lens.b;
#endif
#endif
#else
    const random4 u = PATH_DRAW(key.x, key.y, random_dimension_camera);
#endif
#if TRAIT_FILTER
    /* The film has the pixels around it, too, for which samples beyond it count. */
    const real border = R(TRAIT_FILTER - 1);
    const real offset_x = filter_offset(filter_offsets, filter_place_of(u.a)) - border;
    const real offset_y = filter_offset(filter_offsets, filter_place_of(u.b)) - border;
#else
    const real offset_x = u.a - R(0.5), offset_y = u.b - R(0.5);
#endif
#if PLANES
    const int is_offset = plane > 0u, is_across = plane - 1u < 2u;
    const int step = (plane & 1u) != 0u ? 1 : -1;
    const int to_x = (int)(x - crop_x) + ((is_offset & is_across) ? step : 0);
    const int to_y = (int)line + ((is_offset & !is_across) ? step : 0);
    const int exists = (to_x >= 0) & (to_y >= 0) & (to_x < (int)crop_width) & (to_y < (int)crop_height);
    AT(gather, radius, slot) = exists ? R(0) : gather_absent;
    SET_RGB_IN(direct, radiance, value, slot, rgb_gray(R(0)));
    const real film_x = (real)(to_x + (int)crop_x) + R(0.5) + offset_x;
    const real film_y = (real)(to_y + (int)crop_y) + R(0.5) + offset_y;
#else
    const int exists = 1;
    const real film_x = (real)x + R(0.5) + offset_x;
    const real film_y = (real)y + R(0.5) + offset_y;
#endif
    const camera_sight sight = camera_sight_through(camera, unit, film_x, film_y, u.c, u.d);
    SET_V3(ray, origin, row, sight.origin);
    SET_V3(ray, direction, row, sight.direction);
    AT_UINT(ray, primitive, row) = exists ? (TRAIT_HIDE_EMITTERS ? ray_unhindered : ray_pending) : ray_none;

    BEGIN_PATH(row, slot, key.x, key.y)
    SET_RGB(radiance, value, slot, rgb_gray(R(0)));
#if TRAIT_AOV
    SET_RGB(feature, albedo, slot, rgb_gray(R(0)));
    SET_V3(feature, normal, slot, v3(R(0), R(0), R(0)));
    AT(feature, depth, slot) = R(0);
    AT(feature, weight, slot) = R(1);
#endif
}
