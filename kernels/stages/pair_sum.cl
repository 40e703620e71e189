/* pair_sum: adds what the pairs in the window of the list are worth to the sums of their gather points, rows `first` +
 * `from` on of `gather`. They are added one by one in the order of the list, so that it does not matter where windows
 * begin. */
#include "kernels/lib/gather_row.h"
#include "kernels/shared/stage.h"

STAGE pair_sum(uint count, uint first, uint from, uint window_first, uint window_pairs, uint gather_rows,
               uint pair_rows, __global const uint *pair_chunk_first, __global const uint *pair_offset,
               __global const uint *pair_count, __global const real *pair_value, __global real *gather GATHER_INDEX) {
    const uint item = (uint)work_item();
    if (item >= count)
        return;
    const uint place = from + item, row = GATHER_ROW(first + place);
    PAIRS_IN_WINDOW(place)
    rgb sum = AT_RGB(gather, sum, row);
    for (uint i = low; i < high; ++i)
        sum = rgb_add(sum, AT_RGB(pair_value, value, i - window_first));
    SET_RGB(gather, sum, row, sum);
}
