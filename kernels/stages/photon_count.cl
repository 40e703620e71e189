/* photon_count: adds up, for the statistics, how many of `rows` photons from `first` on in `moved` have arrived. Each
 * work-item has PARTITION_CHUNK rows and a place of its own. */
#include "kernels/shared/stage.h"

STAGE photon_count(uint count, uint first, uint rows, uint to, uint pair_rows, __global const real *moved,
                   __global uint *photon_found) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint end = min((chunk + 1u) * PARTITION_CHUNK, rows);
    uint found = 0u;
    for (uint row = chunk * PARTITION_CHUNK; row < end; ++row)
        found += AT_UINT(moved, primitive, first + row) < ray_first_special ? 1u : 0u;
    photon_found[to + chunk] += found;
}
