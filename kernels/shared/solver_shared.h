/* Sizes that the solver's kernels and its host code agree on. */
#ifndef GRADUS_SHARED_SOLVER_SHARED_H
#define GRADUS_SHARED_SOLVER_SHARED_H

/* Columns of a work-group, all in one row. */
#define SOLVER_TILE 64

/* Zeros left of a row, which are at the same time right of the row above; a multiple of a cache line. */
#define SOLVER_MARGIN 16

/* How many partial sums an item of `reduce` adds. */
#define SOLVER_REDUCTION 16

/* Scalars that kernels leave for each other, by channel. SOLVER_HISTORY and on: one for each iteration. */
#define SOLVER_SCALAR_SLOTS 4160
#define SOLVER_HISTORY 64

/* Side of the blocks in which the mean correction looks for outliers. */
#define SOLVER_BLOCK 32

/* One of the coarsest grids, whose planes lie one after the other in common buffers (kernels/solver/coarse_cycle.cl).
 */
typedef struct {
    unsigned width, height;
    unsigned row, plane;   /* elements from a row to the next, and from a channel */
    unsigned values;       /* where the grid begins in buffers with planes for channels */
    unsigned weights;      /* and in those with planes of weights */
    unsigned weight_plane; /* elements from a channel's weights to the next; 0 where all share one */
} solver_level;

#endif
