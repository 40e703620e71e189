/* walk_link: asks whether the last segments of chains that have arrived are open; they are the only ones that no ray of
 * the walk has traced. walk_seen: reads the answer. */
#include "kernels/lib/ray_start.h"
#include "kernels/shared/stage.h"

STAGE walk_link(uint count, uint chain_rows, uint chain_vertices, __global const real *chain,
                __global const real *walked, __global const real *walked_vertex, __global real *walk_link) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const int has_arrived = AT_UINT(walked, outcome, row) == walk_arrived;
    const uint number = AT_UINT(chain, inner, row);
    const size_t last = (size_t)(has_arrived ? number - 1u : 0u) * chain_rows + row;
    const vec3 from = AT_V3(walked_vertex, position, last), target = AT_V3(chain, target, row);
    const vec3 normal = AT_V3(chain, target_normal, row);
    const vec3 end = connection_end(target, normal, AT(chain, target_offset, row), v3_sub(target, from));
    const vec3 origin =
        ray_origin(from, AT_V3(walked_vertex, geometric, last), AT(walked_vertex, offset, last), v3_sub(target, from));
    SET_V3(walk_link, origin, row, origin);
    const vec3 way = v3_sub(end, origin);
    SET_V3(walk_link, direction, row, way);
    AT_UINT(walk_link, open, row) = has_arrived ? 1u : 0u;
}

STAGE walk_seen(uint count, uint chain_rows, __global real *walked, __global const real *walk_link) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint outcome = AT_UINT(walked, outcome, row), open = AT_UINT(walk_link, open, row);
    AT_UINT(walked, outcome, row) = outcome == walk_arrived && open == 0u ? walk_hidden : outcome;
}
