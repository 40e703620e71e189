/* Kernels that call one function of kernels/lib on arguments from memory: what the device makes of it is measured
 * against what its double build makes of it. Columns, as in the tables of the renderer: IN(c) is argument c of this
 * item, OUT(c) result c. */
#ifndef GRADUS_MEASURE_FUNCTION_H
#define GRADUS_MEASURE_FUNCTION_H
#include "kernels/shared/stage.h"

#define MEASURE_ARGUMENTS uint count, __global const real *in, __global real *out
#define MEASURE_ITEM                                                                                                   \
    const size_t i = work_item();                                                                                      \
    if (i >= count)                                                                                                    \
        return;

#define IN(column) in[(size_t)(column)*count + i]
#define IN_V3(column) v3(IN(column), IN((column) + 1), IN((column) + 2))
#define OUT(column) out[(size_t)(column)*count + i]
#define OUT_V3(column, value)                                                                                          \
    OUT(column) = (value).x;                                                                                           \
    OUT((column) + 1) = (value).y;                                                                                     \
    OUT((column) + 2) = (value).z

#endif
