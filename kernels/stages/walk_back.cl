/* walk_turn: chains that have arrived ask for the walk back, in tables of the same columns. walk_turn_vertices: their
 * vertices; get_global_id(2) is the vertex. walk_return: chains whose walk back has not come back have not arrived. */
//! traits: TRAIT_BLENDS
#include "kernels/lib/chain_start.h"
#include "kernels/shared/stage.h"

STAGE walk_turn(uint count, uint chain_rows, __global const real *chain, __global const real *walked,
                __global real *back_chain) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const int has_arrived = AT_UINT(walked, outcome, row) == walk_arrived;
    const uint number = AT_UINT(chain, inner, row);
#define COPY_V3(to, from)                                                                                              \
    AT_IN(back_chain, chain, to##_x, row) = AT(chain, from##_x, row);                                                  \
    AT_IN(back_chain, chain, to##_y, row) = AT(chain, from##_y, row);                                                  \
    AT_IN(back_chain, chain, to##_z, row) = AT(chain, from##_z, row);
    COPY_V3(start, start)
    COPY_V3(start_normal, start_normal)
    COPY_V3(end, target)
    COPY_V3(end_normal, target_normal)
    COPY_V3(target, end)
    COPY_V3(target_normal, end_normal)
    AT_IN(back_chain, chain, start_offset, row) = AT(chain, start_offset, row);
    AT_UINT_IN(back_chain, chain, inner, row) = has_arrived ? number : 0u;
}

STAGE walk_turn_vertices(uint count, uint chain_rows, uint chain_vertices, __global const real *walked_vertex,
                         __global real *back_chain_vertex) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const size_t at = (size_t)get_global_id(2) * chain_rows + row;
    AT_IN(back_chain_vertex, chain_vertex, position_x, at) = AT(walked_vertex, position_x, at);
    AT_IN(back_chain_vertex, chain_vertex, position_y, at) = AT(walked_vertex, position_y, at);
    AT_IN(back_chain_vertex, chain_vertex, position_z, at) = AT(walked_vertex, position_z, at);
    AT_UINT_IN(back_chain_vertex, chain_vertex, primitive, at) = AT_UINT(walked_vertex, primitive, at);
#if TRAIT_BLENDS
    AT_UINT_IN(back_chain_vertex, chain_vertex, record, at) = AT_UINT(walked_vertex, material, at);
#endif
}

STAGE walk_return(uint count, uint chain_rows, uint chain_vertices, real walk_back_tolerance,
                  __global const real *chain, __global const real *chain_vertex, __global real *walked,
                  __global const real *back_walked, __global const real *back_walked_vertex) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint outcome = AT_UINT(walked, outcome, row), back = AT_UINT_IN(back_walked, walked, outcome, row);
    const vec3 here = AT_V3(chain_vertex, position, row);
    const vec3 there = AT_V3_IN(back_walked_vertex, walked_vertex, position, row);
    const int is_far = chain_start_is_far(AT(chain, start_offset, row));
    const vec3 measured_from = v3_select(is_far, AT_V3(chain, target, row), AT_V3(chain, start, row));
    const vec3 off = v3_sub(there, here), way = v3_sub(here, measured_from);
    const real tolerance = walk_back_tolerance * r_sqrt(v3_dot(way, way)) + traced_rounding(here, there);
    const int is_back = back == walk_arrived && v3_dot(off, off) <= tolerance * tolerance;
    AT_UINT(walked, outcome, row) = outcome == walk_arrived && !is_back ? walk_back : outcome;
}
