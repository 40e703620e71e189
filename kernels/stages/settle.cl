/* settle: after the light found at second vertices was added, offset paths that do not see theirs have failed; and all
 * have where the vertex is of a Dirac kind. Vertices `first` on, offset by offset. */
#include "kernels/shared/stage.h"

STAGE settle(uint count, uint first, uint capacity, uint is_dirac, __global real *shifted, __global const real *link,
             uint link_first, uint link_stride) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + first + i;
        const real ratio = AT(shifted, ratio, at);
        const int open = is_dirac == 0u && AT_UINT(link, open, link_first + (size_t)j * link_stride + i) != 0u;
        AT(shifted, ratio, at) = ratio < R(0) || open ? ratio : shift_failed;
    }
}

/* No offset path of these first vertices asks for anything. */
STAGE close_links(uint count, uint first, uint capacity, __global real *link, uint link_stride) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
#pragma unroll
    for (uint j = 0; j < 4; ++j)
        AT_UINT(link, open, (size_t)j * link_stride + first + i) = 0u;
}
