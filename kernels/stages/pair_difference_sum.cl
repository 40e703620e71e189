/* pair_difference_sum: adds the differences of the pairs in the window of the list to those of their paths: offset j =
 * get_global_id(2). As pair_sum does with what the pairs are worth. */
#include "kernels/lib/gather_row.h"
#include "kernels/shared/stage.h"

STAGE pair_difference_sum(uint count, uint first, uint from, uint window_first, uint window_pairs, uint slots,
                          uint pair_rows, __global const uint *pair_chunk_first, __global const uint *pair_offset,
                          __global const uint *pair_count, __global const real *pair_difference,
                          __global real *difference GATHER_INDEX) {
    const uint item = (uint)work_item();
    if (item >= count)
        return;
    const uint place = from + item;
    PAIRS_IN_WINDOW(place)
    const size_t j = get_global_id(2), to = j * slots + GATHER_ROW(first + place), line = j * pair_rows;
    rgb sum = AT_RGB(difference, value, to);
    for (uint i = low; i < high; ++i)
        sum = rgb_add(sum, AT_RGB(pair_difference, value, line + (i - window_first)));
    SET_RGB(difference, value, to, sum);
}
