/* settle: after the light found at new vertices was added, offset paths that reconnected but do not see theirs have
 * failed; so have all where the vertex is not rough and the path only ended there. Vertices `first` on. */
//! traits: TRAIT_APART
#include "kernels/shared/stage.h"

STAGE settle(uint count, uint first, uint capacity, __global real *shifted, __global const real *link, uint link_first,
             uint link_stride
#if TRAIT_APART
             ,
             __global const real *vertex, __global const uint *material_kind
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
#if TRAIT_APART
    const uint is_rough = material_kind[AT_UINT(vertex, material, first + i)] & kind_is_rough;
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + first + i;
        const real ratio = AT(shifted, ratio, at);
        const int open = AT_UINT(link, open, link_first + (size_t)j * link_stride + i) != 0u;
        int holds = open;
#if TRAIT_APART
        holds = (open & (is_rough != 0u)) | (AT_UINT(shifted, state, at) != shift_reconnected);
#endif
        AT(shifted, ratio, at) =
            ratio < R(0) || holds ? ratio : shift_failed(open ? outcome_failed_kinds : outcome_failed_hidden);
    }
}

/* No offset path of these vertices asks whether it sees a light. */
STAGE close_links(uint count, uint first, uint capacity, __global real *link, uint link_stride) {
    const size_t i = work_item();
    if (i >= count)
        return;
#pragma unroll
    for (uint j = 0; j < 4; ++j)
        AT_UINT(link, open, (size_t)j * link_stride + first + i) = 0u;
}
