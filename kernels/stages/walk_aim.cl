/* walk_aim: the first ray of each walk, at where its first vertex is wanted: the share of the step that it tries. Walks
 * that go on take rows side by side, in the order of the index. */
#include "kernels/lib/chain_start.h"
#include "kernels/shared/stage.h"

STAGE walk_aim(uint count, uint chain_rows, __global const uint *walk_index, __global const real *chain,
               __global const real *walk_old, __global real *walk, __global real *walk_ray, __global real *walk_beam) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint old = walk_index[row];
    const uint number = AT_UINT_IN(walk_old, walk, chain, old);
    const vec3 position = AT_V3_IN(walk_old, walk, first, old), step = AT_V3_IN(walk_old, walk, move, old);
    const real tried = AT_IN(walk_old, walk, share, old);
    AT_UINT(walk, chain, row) = number;
    AT_UINT(walk, steps, row) = AT_UINT_IN(walk_old, walk, steps, old);
    AT_UINT(walk, outcome, row) = AT_UINT_IN(walk_old, walk, outcome, old);
    SET_V3(walk, first, row, position);
    SET_V3(walk, move, row, step);
    AT(walk, share, row) = tried;
    AT(walk, miss, row) = AT_IN(walk_old, walk, miss, old);

    chain_start start;
    start.position = AT_V3(chain, start, number);
    start.normal = AT_V3(chain, start_normal, number);
    start.offset = AT(chain, start_offset, number);
    const vec3 onward = v3_sub(AT_V3(chain, target, number), position);
    const chain_ray ray = chain_ray_through(start, v3_mad(position, tried, step), r_sqrt(v3_dot(onward, onward)));
    const ray_differential beam = ray.beam;
    SET_V3(walk_ray, origin, row, ray.origin);
    SET_V3(walk_ray, direction, row, ray.direction);
    AT_UINT(walk_ray, primitive, row) = ray_pending;
    SET_V3(walk_beam, from, row, ray.from);
    AT(walk_beam, turn, row) = R(1);
    AT_UINT(walk_beam, outcome, row) = walk_unfinished;
    SET_V3(walk_beam, position_s, row, beam.position_s);
    SET_V3(walk_beam, position_t, row, beam.position_t);
    SET_V3(walk_beam, direction_s, row, beam.direction_s);
    SET_V3(walk_beam, direction_t, row, beam.direction_t);
    SET_V3(walk_beam, first, row, position);
    SET_V3(walk_beam, first_s, row, beam.position_s);
    SET_V3(walk_beam, first_t, row, beam.position_t);
}
