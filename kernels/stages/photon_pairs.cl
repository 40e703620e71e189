/* photon_pairs: which photons are near enough to a gather point to be gathered there: rows `first` + `from` on of
 * `gather`. With LIST 0 it counts them into `pair_count`; with LIST 1 it lists those that lie in the window of the
 * list, [window_first, window_first + window_pairs), as rows of `gather` and of `photon_sorted`. A gather point's pairs
 * lie one after the other, in the order of the cells and, within a cell, of the photons.
 *
 * A photon counts where it is within the radius, on a surface that faces the same way (so that one side of a thin wall
 * does not shine through to the other, and one wall not around a corner to the next), and where both paths together are
 * not too long. Cells of lines that share keys hold strangers: these are of another line.
 *
 * A gather point that reaches over more lines of cells than a share of the photons looks at all photons instead, in
 * their order: so no single one, towards the horizon or behind a mirror, takes longer than that.
 *
 * A gather point whose pairs are cut by the end of a window leaves a mark, from which the next window goes on: so each
 * photon is looked at once, or twice in the block where the end fell, however many windows there are. `pair_looked`
 * says how many were.
 *
 * The loops are of a length that is only known here, so work-items are not joined to vectors; what is done for each
 * pair is done elsewhere (photon_evaluate). */
#include "kernels/lib/gather_row.h"
#include "kernels/lib/photon_grid.h"
#include "kernels/lib/shift_photon.h"
#include "kernels/shared/stage.h"

/* Photons that are tested at once before any is listed. */
#define PHOTON_BLOCK 32u
/* Photons that are tested in the time that one line of cells takes. */
#define PHOTONS_A_LINE R(8)

/* Where a gather point's list was cut: the line of cells, counted from its first one; the first photon of the block;
 * and how many pairs come before that. */
#define MARK(column) pair_mark[(size_t)(column)*capacity + place]
#define MARK_LINE 0u
#define MARK_PHOTON 1u
#define MARK_PAIRS 2u

/* 1 where the photon in row i counts. All is computed, for most photons that are looked at are near. */
#define SQUARED(i, axis)                                                                                               \
    ((AT(photon_sorted, position_##axis, i) - at.axis) * (AT(photon_sorted, position_##axis, i) - at.axis))
#define COUNTS(i)                                                                                                      \
    ((SQUARED(i, x) + SQUARED(i, y) + SQUARED(i, z) <= squared) &                                                      \
     (v3_dot(AT_V3(photon_sorted, normal, i), normal) > GRADUS_PHOTON_LEAST_FACING) &                                  \
     (AT_UINT(photon_sorted, depth, i) <= deepest) & (takes_all | (photon_line_sorted[i] == line)))

STAGE photon_pairs(uint count, uint first, uint from, uint gather_rows, uint photon_rows, uint photons_sorted,
                   PHOTON_GRID, real grid_reach, __global const real *gather, __global const real *photon_sorted,
                   __global const uint *photon_line_sorted, __global const uint *photon_first,
                   __global uint *pair_looked GATHER_INDEX
#if LIST
                   ,
                   uint window_first, uint window_pairs, uint capacity, __global const uint *pair_chunk_first,
                   __global const uint *pair_offset, __global const uint *pair_count, __global uint *pair_mark,
                   __global uint *pair_gather, __global uint *pair_photon
#else
                   ,
                   __global uint *pair_count
#endif
) {
    const uint item = (uint)work_item();
    if (item >= count)
        return;
    const uint place = from + item, row = GATHER_ROW(first + place);
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
    const uint wide = y1 - y0 + 1u, high = z1 - z0 + 1u;
    const int takes_all = PHOTONS_A_LINE * (real)wide * (real)high > (real)photons_sorted;
    const uint lines = takes_all ? 1u : wide * high;
#if LIST
    /* Where the next pair goes, less where the window begins: below 0 before it. */
    const int begin = (int)(pair_chunk_first[place / PAIR_CHUNK] + pair_offset[place] - window_first);
    if (begin + (int)pair_count[place] <= 0 || begin >= (int)window_pairs)
        return; /* all in other windows */
    const int is_cut = begin < 0;
    int to = begin + (is_cut ? (int)MARK(MARK_PAIRS) : 0);
    uint looked = pair_looked[place];
    for (uint k = is_cut ? MARK(MARK_LINE) : 0u; k < lines; ++k) {
#else
    uint found = 0;
    for (uint k = 0u; k < lines; ++k) {
#endif
        const uint line = photon_line(y0 + k % wide, z0 + k / wide, grid_last_y);
        const uint key = photon_line_key(line, line_stride, line_shift);
        const uint begins = takes_all ? 0u : photon_first[key + x0];
        const uint end = takes_all ? photons_sorted : photon_first[key + x1 + 1u];
#if LIST
        /* A block at a time, first which count, then which these are, then to the list: the first loop becomes vectors,
         * and none has a branch that nobody can foresee. The last compares each place with the window: with bounds from
         * `max` and `min`, which may cross, PoCL 3.1 wrote beyond the window. */
        const int goes_on = is_cut && k == MARK(MARK_LINE);
        for (uint block = goes_on ? MARK(MARK_PHOTON) : begins; block < end; block += PHOTON_BLOCK) {
            const uint rows = min(end - block, PHOTON_BLOCK);
            looked += rows;
            uint counts[PHOTON_BLOCK], near[PHOTON_BLOCK];
            for (uint n = 0; n < rows; ++n)
                counts[n] = COUNTS(block + n) ? 1u : 0u;
            int found = 0;
            for (uint n = 0; n < rows; ++n) {
                near[found] = block + n;
                found += (int)counts[n];
            }
            for (int n = 0; n < found; ++n)
                if (to + n >= 0 && to + n < (int)window_pairs) {
                    pair_gather[to + n] = row;
                    pair_photon[to + n] = near[n];
                }
            if (to + found >= (int)window_pairs) {
                MARK(MARK_LINE) = k;
                MARK(MARK_PHOTON) = block;
                MARK(MARK_PAIRS) = (uint)(to - begin);
                pair_looked[place] = looked;
                return;
            }
            to += found;
        }
#else
        for (uint i = begins; i < end; ++i)
            found += COUNTS(i) ? 1u : 0u;
#endif
    }
#if LIST
    pair_looked[place] = looked;
#else
    pair_looked[place] = 0u;
    pair_count[place] = found;
#endif
}
