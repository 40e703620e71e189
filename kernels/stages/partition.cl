/* partition: sorts the rows of a batch by bin, keeping their order within a bin (a counting sort in three kernels).
 * Leaves `index`, the rows bin by bin, and `range`: bin b has the places range[b] to range[b + 1].
 *
 * Each work-item counts and scatters PARTITION_CHUNK rows of its own, so no atomics are needed (one costs 30 ns on
 * PoCL) and the order is always the same. */
#include "kernels/shared/stage.h"

STAGE partition_count(uint count, uint bins, uint chunks, __global const uint *bin, __global uint *offset) {
    const uint chunk = (uint)work_item();
    if (chunk >= chunks)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, count);
    for (uint b = 0; b < bins; ++b) {
        uint found = 0;
        for (uint row = begin; row < end; ++row)
            found += bin[row] == b ? 1u : 0u;
        offset[b * chunks + chunk] = found;
    }
}

STAGE partition_scan(uint bins, uint chunks, __global uint *offset, __global uint *range) {
    if (work_item() != 0)
        return;
    uint sum = 0;
    for (uint b = 0; b < bins; ++b) {
        range[b] = sum;
        for (uint chunk = 0; chunk < chunks; ++chunk) {
            const uint found = offset[b * chunks + chunk];
            offset[b * chunks + chunk] = sum;
            sum += found;
        }
    }
    range[bins] = sum;
}

STAGE partition_scatter(uint count, uint bins, uint chunks, __global const uint *bin, __global uint *offset,
                        __global uint *index) {
    const uint chunk = (uint)work_item();
    if (chunk >= chunks)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, count);
    for (uint row = begin; row < end; ++row) {
        const uint b = bin[row];
        if (b < bins)
            index[offset[b * chunks + chunk]++] = row;
    }
}
