/* The grid that photons are sorted by, and where in the order the cells of one line along x lie. */
#ifndef GRADUS_LIB_PHOTON_GRID_H
#define GRADUS_LIB_PHOTON_GRID_H
#include "kernels/lib/vector.h"

GRADUS_LIB_BEGIN

/* Cells are cubes, numbered from a corner of the scene's box. What lies beyond the box counts as in the last cells. */
typedef struct {
    vec3 low;                    /* the corner, world units */
    real inverse_edge;           /* of a cell */
    real last_x, last_y, last_z; /* the highest cells */
    GRADUS_NOT_IN_REGISTERS
} photon_grid;

/* The same as kernel arguments. Cells of a line along x have keys one after the other, from photon_line_key on. Where
 * there are few enough cells, `line_stride` is the length of a line and no two share a key; else it hashes, and lines
 * overlap. */
#define PHOTON_GRID                                                                                                    \
    real grid_low_x, real grid_low_y, real grid_low_z, real grid_inverse_edge, uint grid_last_x, uint grid_last_y,     \
        uint grid_last_z, uint line_stride, uint line_shift
#define PHOTON_GRID_OF_ARGUMENTS                                                                                       \
    photon_grid_of(grid_low_x, grid_low_y, grid_low_z, grid_inverse_edge, grid_last_x, grid_last_y, grid_last_z)

GRADUS_FN photon_grid photon_grid_of(real low_x, real low_y, real low_z, real inverse_edge, uint last_x, uint last_y,
                                     uint last_z) {
    photon_grid grid;
    grid.low = v3(low_x, low_y, low_z);
    grid.inverse_edge = inverse_edge;
    grid.last_x = (real)last_x;
    grid.last_y = (real)last_y;
    grid.last_z = (real)last_z;
    return grid;
}

/* The cell along one axis. It never falls as x grows, whatever rounding does. */
GRADUS_FN uint photon_cell(real x, real low, real inverse_edge, real last) {
    return (uint)(int)r_clamp((x - low) * inverse_edge, R(0), last);
}

/* The number of a line of cells along x: no two share one. */
GRADUS_FN uint photon_line(uint y, uint z, uint last_y) { return z * (last_y + 1u) + y; }

/* The key of its first cell. */
GRADUS_FN uint photon_line_key(uint line, uint line_stride, uint line_shift) {
    return (line * line_stride) >> line_shift;
}

GRADUS_LIB_END
#endif
