/* What every stage kernel starts from. */
#ifndef GRADUS_SHARED_STAGE_H
#define GRADUS_SHARED_STAGE_H
#include "kernels/lib/vector.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/tables.h"

/* The work-group size is fixed: PoCL compiles a kernel anew for every other one. */
#define STAGE __attribute__((reqd_work_group_size(WORK_GROUP_SIZE, 1, 1))) __kernel void

/* Names that a kernel variant is compiled for: PASTE(BSDF, _sample) is diffuse_sample with -D BSDF=diffuse. */
#define PASTE_NOW(a, b) a##b
#define PASTE(a, b) PASTE_NOW(a, b)

#endif
