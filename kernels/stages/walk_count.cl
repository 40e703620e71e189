/* walk_count: how many of `rows` chains have each outcome, a work-item each, and at last the steps of those that have
 * arrived. */
#include "kernels/shared/stage.h"

STAGE walk_count(uint count, uint rows, uint chain_rows, __global const real *walked, __global uint *walk_found) {
    const uint which = (uint)work_item();
    if (which >= count)
        return;
    uint found = 0u;
    for (uint row = 0; row < rows; ++row) {
        const uint outcome = AT_UINT(walked, outcome, row);
        const uint steps = outcome == walk_arrived ? AT_UINT(walked, steps, row) : 0u;
        found += which == walk_outcomes ? steps : outcome == which ? 1u : 0u;
    }
    walk_found[which] = found;
}
