/* group_materials: which class each ray's material is of (runtime/scene/material_class.h), by which the rows of
 * `traced` are sorted for `material`. Rays that met nothing are left out. */
#include "kernels/shared/stage.h"

STAGE group_materials(uint count, uint unit, uint traced_rows, __global const real *traced, __global uint *bin,
                      __global const uint *primitive_material, __global const uint *material_class) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint met = AT_UINT(traced, primitive, row);
    const int is_hit = met < ray_first_special;
    const uint primitive = is_hit ? met : 0u;
    const uint found = material_class[material_record(OF_PRIMITIVE(primitive_material, material, primitive))];
    bin[row] = is_hit ? found : bin_none;
}
