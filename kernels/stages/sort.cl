/* sort: brings rows into the order of their keys, keeping the order of equal ones (a radix sort, digit by digit, the
 * least significant first: Knuth 1998, 5.2.5). Leaves `sort_key`, the keys in order, and `sort_index`, their rows.
 *
 * There are `rows` rows, and each work-item of sort_count and sort_scatter has `chunk_rows` of its own. So no atomics
 * are needed. The order does not depend on how rows are shared out, since there is but one that is stable. */
#include "kernels/shared/stage.h"

/* The keys as they lie; larger ones than `last` become that. */
STAGE sort_begin(uint count, uint last, __global const uint *sort_from, __global uint *sort_key,
                 __global uint *sort_index) {
    const size_t i = work_item();
    if (i >= count)
        return;
    sort_key[i] = min(sort_from[i], last);
    sort_index[i] = (uint)i;
}

/* Other keys of the same rows, in the order that these have now. */
STAGE sort_again(uint count, uint last, __global const uint *sort_from, __global const uint *sort_index,
                 __global uint *sort_key_next, __global uint *sort_index_next) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = sort_index[i];
    sort_key_next[i] = min(sort_from[row], last);
    sort_index_next[i] = row;
}

/* How often each value of the digit, one of `values`, occurs in each chunk. */
STAGE sort_count(uint count, uint rows, uint chunk_rows, uint shift, uint values, uint stride,
                 __global const uint *sort_key, __global uint *sort_place) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * chunk_rows;
    const uint end = min(begin + chunk_rows, rows);
    __global uint *found = sort_place + (size_t)chunk * stride;
    for (uint value = 0; value < values; ++value)
        found[value] = 0;
    for (uint i = begin; i < end; ++i)
        ++found[(sort_key[i] >> shift) & (values - 1u)];
}

/* For each value of the digit, how often it occurs in the chunks before, and in all. */
STAGE sort_total(uint count, uint chunks, uint stride, __global uint *sort_place, __global uint *sort_found) {
    const size_t value = work_item();
    if (value >= count)
        return;
    uint sum = 0;
    for (uint chunk = 0; chunk < chunks; ++chunk) {
        const size_t at = (size_t)chunk * stride + value;
        const uint found = sort_place[at];
        sort_place[at] = sum;
        sum += found;
    }
    sort_found[value] = sum;
}

STAGE sort_scatter(uint count, uint rows, uint chunk_rows, uint shift, uint values, uint stride,
                   __global const uint *sort_key, __global const uint *sort_index, __global uint *sort_place,
                   __global const uint *sort_found, __global uint *sort_key_next, __global uint *sort_index_next) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * chunk_rows;
    const uint end = min(begin + chunk_rows, rows);
    __global uint *place = sort_place + (size_t)chunk * stride;
    uint before = 0;
    for (uint value = 0; value < values; ++value) {
        place[value] += before;
        before += sort_found[value];
    }
    for (uint i = begin; i < end; ++i) {
        const uint key = sort_key[i];
        const uint to = place[(key >> shift) & (values - 1u)]++;
        sort_key_next[to] = key;
        sort_index_next[to] = sort_index[i];
    }
}
