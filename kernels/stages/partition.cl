/* partition: sorts the rows of a batch by bin, keeping their order within a bin (a counting sort in three kernels).
 * Leaves `index`, the rows bin by bin, and `range`: bin b has the places range[b] to range[b + 1].
 *
 * There are `rows` rows and `count` work-items, each of which counts and scatters PARTITION_CHUNK rows of its own. So
 * no atomics are needed (one costs 30 ns on PoCL) and the order is always the same. */
#include "kernels/shared/stage.h"

STAGE partition_count(uint count, uint rows, uint bins, __global const uint *bin, __global uint *chunk_offset) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, rows);
    for (uint b = 0; b < bins; ++b) {
        uint found = 0;
        for (uint row = begin; row < end; ++row)
            found += bin[row] == b ? 1u : 0u;
        chunk_offset[b * count + chunk] = found;
    }
}

STAGE partition_scan(uint count, uint bins, uint chunks, __global uint *chunk_offset, __global uint *range) {
    if (work_item() >= count)
        return;
    uint sum = 0;
    for (uint b = 0; b < bins; ++b) {
        range[b] = sum;
        for (uint chunk = 0; chunk < chunks; ++chunk) {
            const uint found = chunk_offset[b * chunks + chunk];
            chunk_offset[b * chunks + chunk] = sum;
            sum += found;
        }
    }
    range[bins] = sum;
}

STAGE partition_scatter(uint count, uint rows, uint bins, __global const uint *bin, __global uint *chunk_offset,
                        __global uint *index) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, rows);
    for (uint row = begin; row < end; ++row) {
        const uint b = bin[row];
        const int is_kept = b < bins;
        const uint at = (is_kept ? b : 0u) * count + chunk, place = chunk_offset[at];
        /* The last place is free where a row is dropped. Whether one is nobody can foresee, so there is no branch. */
        index[is_kept ? place : rows - 1u] = row;
        chunk_offset[at] = place + (is_kept ? 1u : 0u);
    }
}
