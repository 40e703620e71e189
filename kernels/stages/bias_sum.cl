/* bias_sum: sums what pairs are worth whose photon is within the half of the disc's area that is nearest, for gather
 * points at rows `first` + `from` on of `gather`, as pair_sum does for all. A gather point's first window begins anew.
 */
#include "kernels/lib/gather_row.h"
#include "kernels/lib/vector.h"
#include "kernels/shared/stage.h"

STAGE bias_sum(uint count, uint first, uint from, uint window_first, uint window_pairs, uint gather_rows,
               uint photon_rows, uint pair_rows, __global const uint *pair_chunk_first,
               __global const uint *pair_offset, __global const uint *pair_count, __global const uint *pair_photon,
               __global const real *pair_value, __global const real *gather, __global const real *photon_sorted,
               __global real *gather_inner GATHER_INDEX) {
    const uint item = (uint)work_item();
    if (item >= count)
        return;
    const uint place = from + item, row = GATHER_ROW(first + place);
    PAIRS_IN_WINDOW(place)
    const vec3 at = AT_V3(gather, position, row);
    const real distance = AT(gather, radius, row), squared = R(0.5) * distance * distance;
    /* Selected, not scaled: what another pass left may be no number. */
    rgb sum = rgb_select(begin >= window_first, rgb_gray(R(0)), AT_RGB(gather_inner, value, row));
    for (uint i = low; i < high; ++i) {
        const vec3 apart = v3_sub(AT_V3(photon_sorted, position, pair_photon[i - window_first]), at);
        const real counts = v3_dot(apart, apart) <= squared ? R(1) : R(0);
        sum = rgb_add(sum, rgb_scale(AT_RGB(pair_value, value, i - window_first), counts));
    }
    SET_RGB(gather_inner, value, row, sum);
}
