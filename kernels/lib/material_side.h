/* Which material a surface has on the side that a ray meets. */
#ifndef GRADUS_LIB_MATERIAL_SIDE_H
#define GRADUS_LIB_MATERIAL_SIDE_H
#include "kernels/shared/scene_records.h"

GRADUS_LIB_BEGIN

/* The record of the material of that side, of a number of primitive_material. */
GRADUS_FN uint material_on_side(GRADUS_GLOBAL const uint *material_back, uint sided_material, int is_behind) {
    const uint front = material_record(sided_material), back = material_back[front];
    return (sided_material & material_two_sided) != 0u && is_behind ? back : front;
}

GRADUS_LIB_END
#endif
