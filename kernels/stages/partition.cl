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

/* The same by many work-items, for devices on which one alone is slow: each has a share of chunk_offset, sums it, and
 * begins where those before it end. */
GRADUS_FN uint share_begin(uint lane, uint lanes, uint places) { return (uint)((ulong)places * lane / lanes); }

STAGE partition_share(uint count, uint bins, uint chunks, __global const uint *chunk_offset,
                      __global uint *share_count) {
    const uint lane = (uint)work_item(), places = bins * chunks;
    if (lane >= count)
        return;
    uint sum = 0;
    for (uint place = share_begin(lane, count, places); place < share_begin(lane + 1u, count, places); ++place)
        sum += chunk_offset[place];
    share_count[lane] = sum;
}

STAGE partition_scan_shares(uint count, uint bins, uint chunks, __global const uint *share_count,
                            __global uint *chunk_offset, __global uint *range) {
    const uint lane = (uint)work_item(), places = bins * chunks;
    if (lane >= count)
        return;
    uint sum = 0;
    for (uint before = 0; before < lane; ++before)
        sum += share_count[before];
    const uint end = share_begin(lane + 1u, count, places);
    uint place = share_begin(lane, count, places);
    for (uint b = place / chunks; place < end; ++b) {
        if (place == b * chunks)
            range[b] = sum;
        for (const uint end_here = min((b + 1u) * chunks, end); place < end_here; ++place) {
            const uint found = chunk_offset[place];
            chunk_offset[place] = sum;
            sum += found;
        }
    }
    if (end == places)
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
