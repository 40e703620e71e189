/* shift_count: adds up what became of offset paths on their way to `rows` vertices from `first` on. Each work-item has
 * PARTITION_CHUNK rows and a place of its own for each outcome, so the sums do not depend on who comes first. */
//! traits: TRAIT_APART
#include "kernels/shared/stage.h"

STAGE shift_count(uint count, uint first, uint capacity, uint rows, uint chunks_at_most, __global const real *offset,
                  __global uint *outcome) {
    const uint chunk = (uint)work_item();
    if (chunk >= count)
        return;
    const uint end = min((chunk + 1u) * PARTITION_CHUNK, rows);
    uint found[shift_outcomes];
    for (uint k = 0; k < shift_outcomes; ++k)
        found[k] = 0u;
    for (uint j = 0; j < 4; ++j)
        for (uint row = chunk * PARTITION_CHUNK; row < end; ++row) {
            const size_t at = (size_t)j * capacity + first + row;
            const real ratio = AT(offset, ratio, at);
            const uint reason = (uint)((R(-1) - ratio) * R(16) + R(0.5));
            uint state = connection_recent;
#if TRAIT_APART
            state = AT_UINT(offset, state, at);
#endif
            const uint worked = state == connection_recent ? outcome_reconnected : outcome_half_vector;
            const uint became = ratio >= R(0) ? worked : min(reason, (uint)(shift_outcomes - 1));
            /* Those that were connected or failed before did not try. */
            const uint tried = state != connection_full && ratio > shift_first_absent ? 1u : 0u;
            for (uint k = 0; k < shift_outcomes; ++k)
                found[k] += became == k ? tried : 0u;
        }
    for (uint k = 0; k < shift_outcomes; ++k)
        outcome[k * chunks_at_most + chunk] += found[k];
}
