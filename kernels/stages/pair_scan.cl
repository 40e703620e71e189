/* pair_scan: where the pairs of each gather point begin within those of its chunk of PAIR_CHUNK gather points, and how
 * many a chunk has, at most PAIR_TOO_MANY. The host goes on from there. For the statistics, also the sum of the radii.
 */
#include "kernels/lib/gather_row.h"
#include "kernels/shared/stage.h"

STAGE pair_scan(uint count, uint first, uint rows, uint gather_rows, __global const real *gather,
                __global const uint *pair_count, __global uint *pair_offset, __global uint *pair_total,
                __global real *radius_total GATHER_INDEX) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * PAIR_CHUNK;
    const uint end = min(begin + PAIR_CHUNK, rows);
    uint sum = 0;
    real radii = R(0);
    for (uint i = begin; i < end; ++i) {
        pair_offset[i] = sum;
        sum = pair_count[i] > PAIR_TOO_MANY - sum ? PAIR_TOO_MANY : sum + pair_count[i];
        radii += AT(gather, radius, GATHER_ROW(first + i));
    }
    pair_total[chunk] = sum;
    radius_total[chunk] = radii;
}
