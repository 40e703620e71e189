/* photons: the order of photons by light path, and along each, whichever batches they came in. Each light path has
 * counted its own, so this is a counting sort without counting: the counts are added up, and a photon's place is that
 * of its light path and its ordinal. Photons stay where they are: who sorts them goes by this order, and moves them
 * once.
 *
 * As in the partition, each work-item of photons_count and photons_place has PARTITION_CHUNK of the `rows` slots. */
#include "kernels/shared/stage.h"

/* The photons of each chunk of slots. */
STAGE photons_count(uint count, uint rows, __global const uint *photon_place, __global uint *photon_chunk) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, rows);
    uint found = 0;
    for (uint slot = begin; slot < end; ++slot)
        found += photon_place[slot];
    photon_chunk[chunk] = found;
}

STAGE photons_scan(uint count, uint chunks, __global uint *photon_chunk, __global uint *photon_total) {
    if (work_item() >= count)
        return;
    uint sum = 0;
    for (uint chunk = 0; chunk < chunks; ++chunk) {
        const uint found = photon_chunk[chunk];
        photon_chunk[chunk] = sum;
        sum += found;
    }
    photon_total[0] = sum;
}

/* From the number of photons of each slot to the place of its first. */
STAGE photons_place(uint count, uint rows, __global const uint *photon_chunk, __global uint *photon_place) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint begin = chunk * PARTITION_CHUNK;
    const uint end = min(begin + PARTITION_CHUNK, rows);
    uint sum = photon_chunk[chunk];
    for (uint slot = begin; slot < end; ++slot) {
        const uint found = photon_place[slot];
        photon_place[slot] = sum;
        sum += found;
    }
}

/* Which row has the photon of each place. */
STAGE photons_order(uint count, uint photon_rows, __global const real *photon_origin, __global const uint *photon_place,
                    __global uint *photon_order) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint before = AT_UINT(photon_origin, ordinal, i);
    if (before != photon_none)
        photon_order[photon_place[AT_UINT(photon_origin, slot, i)] + before] = (uint)i;
}
