/* partition: sorts the rows of a batch by bin, keeping their order within a bin (a counting sort in three kernels).
 * Leaves `index`, the rows bin by bin, and `range`: bin b has the places range[b] to range[b + 1].
 *
 * There are `rows` rows and `count` work-items, each of which counts and scatters PARTITION_CHUNK rows of its own. So
 * no atomics are needed (one costs 30 ns on PoCL) and the order is always the same. */
#include "kernels/shared/stage.h"

/* Rows that are looked at before any is placed. */
#define PARTITION_BLOCK 32u

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
    /* A block at a time: first which rows are kept, then to their places. Whether one is nobody can foresee, so there
     * is no branch on it. */
    for (uint first = begin; first < end; first += PARTITION_BLOCK) {
        const uint rows_of_block = min(end - first, PARTITION_BLOCK);
        uint kept[PARTITION_BLOCK], found = 0;
        for (uint k = 0; k < rows_of_block; ++k) {
            kept[found] = first + k;
            found += bin[first + k] < bins ? 1u : 0u;
        }
        for (uint k = 0; k < found; ++k)
            index[chunk_offset[bin[kept[k]] * count + chunk]++] = kept[k];
    }
}
