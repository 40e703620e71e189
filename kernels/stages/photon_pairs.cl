/* photon_pairs: which photons are near enough to a gather point to be gathered there: rows `first` + `from` on of
 * `gather`. With LIST 0 it counts them into `pair_count`; with LIST 1 it lists those that lie in the window of the
 * list, [window_first, window_first + window_pairs), as rows of `gather` and of `photon_sorted`. A gather point's pairs
 * lie one after the other, in the order of the cells and, within a cell, of the photons.
 *
 * A photon counts where it is within the radius, on a surface that faces the same way (so that one side of a thin wall
 * does not shine through to the other, and one wall not around a corner to the next), and where both paths together are
 * not too long. Cells of lines that share keys hold strangers: these are of another line.
 *
 * The loops are of a length that is only known here, so work-items are not joined to vectors; what is done for each
 * pair is done elsewhere (photon_evaluate). */
#include "kernels/lib/photon_grid.h"
#include "kernels/shared/stage.h"

STAGE photon_pairs(uint count, uint first, uint from, uint capacity, uint photon_rows, PHOTON_GRID, real grid_reach,
                   __global const real *gather, __global const real *photon_sorted,
                   __global const uint *photon_line_sorted, __global const uint *photon_first
#if LIST
                   ,
                   uint window_first, uint window_pairs, __global const uint *pair_chunk_first,
                   __global const uint *pair_offset, __global uint *pair_gather, __global uint *pair_photon
#else
                   ,
                   __global uint *pair_count
#endif
) {
    const uint item = (uint)work_item();
    if (item >= count)
        return;
    const uint place = from + item, row = first + place;
    const photon_grid grid = PHOTON_GRID_OF_ARGUMENTS;
    const vec3 at = AT_V3(gather, position, row), normal = AT_V3(gather, geometric, row);
    const real distance = AT(gather, radius, row), squared = distance * distance;
    const uint deepest = AT_UINT(gather, deepest, row);
    /* A little more than the radius, or rounding could leave out a cell. */
    const real reach = distance * R(1.0001) + grid_reach;
    const uint x0 = photon_cell(at.x - reach, grid.low.x, grid.inverse_edge, grid.last_x);
    const uint x1 = photon_cell(at.x + reach, grid.low.x, grid.inverse_edge, grid.last_x);
    const uint y0 = photon_cell(at.y - reach, grid.low.y, grid.inverse_edge, grid.last_y);
    const uint y1 = photon_cell(at.y + reach, grid.low.y, grid.inverse_edge, grid.last_y);
    const uint z0 = photon_cell(at.z - reach, grid.low.z, grid.inverse_edge, grid.last_z);
    const uint z1 = photon_cell(at.z + reach, grid.low.z, grid.inverse_edge, grid.last_z);
#if LIST
    /* Wraps below the window, which the comparison takes for beyond it. */
    uint to = pair_chunk_first[place / PAIR_CHUNK] + pair_offset[place] - window_first;
#endif
#if !LIST
    uint found = 0;
#endif
    for (uint z = z0; z <= z1; ++z)
        for (uint y = y0; y <= y1; ++y) {
            const uint line = photon_line(y, z, grid_last_y);
            const uint key = photon_line_key(line, line_stride, line_shift);
            const uint end = photon_first[key + x1 + 1u];
            for (uint i = photon_first[key + x0]; i < end; ++i) {
                const real dx = AT(photon_sorted, position_x, i) - at.x;
                const real dy = AT(photon_sorted, position_y, i) - at.y;
                const real dz = AT(photon_sorted, position_z, i) - at.z;
                const real facing = AT(photon_sorted, normal_x, i) * normal.x +
                                    AT(photon_sorted, normal_y, i) * normal.y +
                                    AT(photon_sorted, normal_z, i) * normal.z;
                const int counts = (dx * dx + dy * dy + dz * dz <= squared) & (facing > PHOTON_LEAST_FACING) &
                                   (AT_UINT(photon_sorted, depth, i) <= deepest) & (photon_line_sorted[i] == line);
#if LIST
                if (counts) {
                    if (to < window_pairs) {
                        pair_gather[to] = row;
                        pair_photon[to] = i;
                    }
                    ++to;
                }
#else
                found += counts ? 1u : 0u;
#endif
            }
        }
#if !LIST
    pair_count[place] = found;
#endif
}
