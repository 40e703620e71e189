/* splat: adds splats to the sums of their pixels. `splat_sorted_key` has their pixels in ascending order, and those
 * that are none after them; `splat_sorted_index` their rows. The work-item at which a pixel begins adds all of its
 * splats, one after the other: so it matters in which order they come, and not where one launch ends and the next
 * begins. A splat with a NaN or an infinity is left out and counted. */
#include "kernels/lib/compensated.h"
#include "kernels/lib/finite.h"
#include "kernels/shared/stage.h"

#define LOAD(sum_column, correction_column)                                                                            \
    { AT_IN(splat_film, film, sum_column, pixel), AT_IN(splat_film, film, correction_column, pixel) }
#define STORE(s, sum_column, correction_column)                                                                        \
    AT_IN(splat_film, film, sum_column, pixel) = s.sum;                                                                \
    AT_IN(splat_film, film, correction_column, pixel) = s.correction;

STAGE splat(uint count, uint pixels, uint splat_rows, __global const uint *splat_sorted_key,
            __global const uint *splat_sorted_index, __global const real *splat, __global real *splat_film) {
    const size_t first = work_item();
    if (first >= count)
        return;
    const uint pixel = splat_sorted_key[first];
    if (pixel >= pixels || (first > 0 && splat_sorted_key[first - 1] == pixel))
        return;
    compensated r = LOAD(sum_r, correction_r);
    compensated g = LOAD(sum_g, correction_g);
    compensated b = LOAD(sum_b, correction_b);
    uint rejected = 0;
    for (size_t i = first; i < count && splat_sorted_key[i] == pixel; ++i) {
        const rgb value = AT_RGB(splat, value, splat_sorted_index[i]);
        if (is_finite(value.r) && is_finite(value.g) && is_finite(value.b)) {
            r = compensated_add(r, value.r);
            g = compensated_add(g, value.g);
            b = compensated_add(b, value.b);
        } else {
            ++rejected;
        }
    }
    STORE(r, sum_r, correction_r)
    STORE(g, sum_g, correction_g)
    STORE(b, sum_b, correction_b)
    AT_UINT_IN(splat_film, film, rejected, pixel) += rejected;
}
