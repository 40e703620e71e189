/* shift_count: adds up what became of offset paths on their way to vertices `first` on. Each work-item has
 * PARTITION_CHUNK rows and a place of its own for each outcome, so the sums do not depend on who comes first. */
//! traits: TRAIT_APART
#include "kernels/shared/stage.h"

STAGE shift_count(uint count, uint first, uint capacity, uint chunks, uint chunks_at_most, __global const real *shifted,
                  __global uint *outcome) {
    const uint chunk = (uint)work_item();
    if (chunk >= chunks)
        return;
    const uint end = min((chunk + 1u) * PARTITION_CHUNK, count);
    uint found[shift_outcomes];
    for (uint k = 0; k < shift_outcomes; ++k)
        found[k] = 0u;
    for (uint j = 0; j < 4; ++j)
        for (uint row = chunk * PARTITION_CHUNK; row < end; ++row) {
            const size_t at = (size_t)j * capacity + first + row;
            const real ratio = AT(shifted, ratio, at);
            const uint reason = (uint)((R(-1) - ratio) * R(16) + R(0.5));
            uint state = shift_reconnected;
#if TRAIT_APART
            state = AT_UINT(shifted, state, at);
#endif
            const uint worked = state == shift_reconnected ? outcome_reconnected : outcome_half_vector;
            const uint became = ratio >= R(0) ? worked : min(reason, (uint)(shift_outcomes - 1));
            /* Those that merged or failed before did not try. */
            const uint tried = state != shift_merged && ratio > shift_first_absent ? 1u : 0u;
            for (uint k = 0; k < shift_outcomes; ++k)
                found[k] += became == k ? tried : 0u;
        }
    for (uint k = 0; k < shift_outcomes; ++k)
        outcome[k * chunks_at_most + chunk] += found[k];
}
