/* photon_cells: brings photons into the order of the cells of a grid (kernels/lib/photon_grid.h). photon_cells says for
 * each row the key of its cell and the number of its line; once the keys are sorted, photon_copy copies the photons in
 * that order, photon_lines their lines, and photon_starts says where the photons of each key begin. */
#include "kernels/lib/photon_grid.h"
#include "kernels/shared/stage.h"

STAGE photon_cells(uint count, uint photon_rows, PHOTON_GRID, __global const real *photon, __global uint *photon_key,
                   __global uint *photon_line_of) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const photon_grid grid = PHOTON_GRID_OF_ARGUMENTS;
    const uint x = photon_cell(AT(photon, position_x, i), grid.low.x, grid.inverse_edge, grid.last_x);
    const uint y = photon_cell(AT(photon, position_y, i), grid.low.y, grid.inverse_edge, grid.last_y);
    const uint z = photon_cell(AT(photon, position_z, i), grid.low.z, grid.inverse_edge, grid.last_z);
    const uint line = photon_line(y, z, grid_last_y);
    photon_key[i] = photon_line_key(line, line_stride, line_shift) + x;
    photon_line_of[i] = line;
}

/* Column get_global_id(2) of `photon`; numbers in the place of a real keep their bits. All columns at once would be
 * twice as slow: so many places at once neither the caches nor their address tables hold. */
STAGE photon_copy(uint count, uint photon_rows, __global const uint *photon_sort_index, __global const real *photon,
                  __global real *photon_sorted) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t column = get_global_id(2) * (size_t)photon_rows;
    photon_sorted[column + i] = photon[column + photon_sort_index[i]];
}

STAGE photon_lines(uint count, __global const uint *photon_sort_index, __global const uint *photon_line_of,
                   __global uint *photon_line_sorted) {
    const size_t i = work_item();
    if (i >= count)
        return;
    photon_line_sorted[i] = photon_line_of[photon_sort_index[i]];
}

/* photon_first[key] is where the photons of a key begin, and where those before it end: also for keys that no photon
 * has, and for one beyond the last. The work-item of each photon does it for the keys since the one before, one more
 * work-item than photons for those at the end. */
STAGE photon_starts(uint count, uint photons, uint keys, __global const uint *photon_sort_key,
                    __global uint *photon_first) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint from = i == 0 ? 0u : photon_sort_key[i - 1] + 1u;
    const uint to = i == photons ? keys : photon_sort_key[i];
    for (uint key = from; key <= to; ++key)
        photon_first[key] = (uint)i;
}
