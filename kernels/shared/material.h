/* What a material is on the device: a record of reals in one array. Record m starts at m * material_stride, its fields
 * in the order of GRADUS_MATERIAL_PARAMETERS, a colour's three channels one after the other, and last the number of its
 * kind. */
#ifndef GRADUS_SHARED_MATERIAL_H
#define GRADUS_SHARED_MATERIAL_H
#include "kernels/shared/bsdf_list.h"
#include "kernels/shared/compat.h"

GRADUS_LIB_BEGIN

#define GRADUS_FIELD_INDEX(name) material_##name,
enum material_field { GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_INDEX) material_stride };
#undef GRADUS_FIELD_INDEX

#define GRADUS_KIND_INDEX(name, lobes, transmits, parameters) bsdf_kind_##name,
enum bsdf_kind { GRADUS_BSDF_KINDS(GRADUS_KIND_INDEX) bsdf_kind_count };
#undef GRADUS_KIND_INDEX

#define GRADUS_FIELD_MEMBER(name) real name;
typedef struct {
    GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_MEMBER)
} material;
#undef GRADUS_FIELD_MEMBER

/* Loads one record; fields that the caller does not use cost nothing once inlined. `unit` is 1, see FIELD_OF in
 * kernels/shared/scene_records.h. */
#define GRADUS_FIELD_LOAD(name) m.name = (materials + material_##name * (size_t)unit)[first];
GRADUS_FN material material_load(GRADUS_GLOBAL const real *materials, uint index, uint unit) {
    const int first = (int)(index * (uint)material_stride);
    material m;
    GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_LOAD)
    return m;
}
#undef GRADUS_FIELD_LOAD

GRADUS_LIB_END
#endif
