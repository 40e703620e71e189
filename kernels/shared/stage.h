/* What every stage kernel starts from. */
#ifndef GRADUS_SHARED_STAGE_H
#define GRADUS_SHARED_STAGE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"

/* The work-group size is fixed: PoCL compiles a kernel anew for every other one. */
#define STAGE __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) __kernel void

/* Whether work-item i has one of `count` rows. What is loaded behind that choice takes a gather, even where all
 * work-items load the same; before it a load for all. Loads that are to stay before it leave their bits in `kept`:
 * `unit` is an argument and always 1, which the compiler does not know, so it cannot move them. */
#define HAS_ROW(i, count, kept) ((i) < (count) + ((kept) & (unit - 1u)))

/* Names that a kernel variant is compiled for: PASTE(BSDF, _sample) is diffuse_sample with -D BSDF=diffuse. */
#define PASTE_NOW(a, b) a##b
#define PASTE(a, b) PASTE_NOW(a, b)

#endif
