/* Tiles of a grid, a work-group each (solver/tiles.h). */
#ifndef GRADUS_SOLVER_TILES_H
#define GRADUS_SOLVER_TILES_H
#include "kernels/solver/vectors.h"

#define TILED_GRID                                                                                                     \
    uint width, uint height, uint row, uint plane, uint first_channel, uint tile_columns, uint tile_rows, uint lanes

/* Defines the channel, the first pixel of the tile, and its inner size. */
#define TILE_PLACE                                                                                                     \
    const uint group = (uint)get_group_id(0), tiles = (width + tile_columns - 1) / tile_columns;                       \
    const uint own = group / tiles, channel = first_channel + own;                                                     \
    const uint first_x = group % tiles * tile_columns, first_y = (uint)get_group_id(1) * tile_rows;                    \
    const uint columns = min(tile_columns, width - first_x), rows = min(tile_rows, height - first_y);

/* Row y of the grid: where it begins in planes of values and of weights. */
#define ON_LINE const size_t line_at = OWN_AT(0, y), line_weight = WEIGHT_AT(0, y);

/* Where the part that an eight of a line has of a sum goes, so that sums do not depend on the shape of tiles:
 * `partials`, one for each eight of the grid, for each channel of the first sum, then of the next. */
#define TILE_PARTIAL(sum, x, y)                                                                                        \
    (((sum) * (get_global_size(0) / WORK_GROUP_SIZE / tiles) + own) * partials + (y)*EIGHTS(width) + (x) / 8)

#endif
