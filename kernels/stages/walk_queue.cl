/* walk_queue: a walk begins for each chain that asks for one, at its own first vertex. Leaves its bin: the longest
 * chains come first, so that those which have one vertex more are the first rows. */
#include "kernels/shared/stage.h"

STAGE walk_queue(uint count, uint chain_rows, uint chain_vertices, uint most_vertices, __global const real *chain,
                 __global const real *chain_vertex, __global real *walk, __global real *walked,
                 __global uint *walk_bin) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint number = AT_UINT(chain, inner, row);
    const int is_asked = number > 0u, fits = number <= most_vertices;
    AT_UINT(walk, chain, row) = (uint)row;
    AT_UINT(walk, steps, row) = 0u;
    AT_UINT(walk, outcome, row) = walk_unfinished;
    const vec3 position = AT_V3(chain_vertex, position, row);
    SET_V3(walk, first, row, position);
    SET_V3(walk, move, row, v3(R(0), R(0), R(0)));
    AT(walk, share, row) = R(1);
    AT(walk, miss, row) = R(1e30);
    AT_UINT(walked, outcome, row) = is_asked ? walk_base : walk_none;
    AT_UINT(walked, steps, row) = 0u;
    walk_bin[row] = is_asked & fits ? most_vertices - number : bin_none;
}
