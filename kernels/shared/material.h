/* What a material is, declared once for host and device.
 *
 * A material is a record of reals in one array: record m starts at m * material_stride, its fields in the order
 * of the list below. The fields that a BSDF kind does not name are ignored by it. */
#ifndef GRADUS_SHARED_MATERIAL_H
#define GRADUS_SHARED_MATERIAL_H
#include "kernels/shared/compat.h"

/* FIELD(name, what it is). Reflectances are unitless RGB factors. */
#define GRADUS_MATERIAL_FIELDS(FIELD)                                                                                  \
    FIELD(reflectance_r, "diffuse: albedo")                                                                            \
    FIELD(reflectance_g, "")                                                                                           \
    FIELD(reflectance_b, "")                                                                                           \
    FIELD(specular_reflectance_r, "conductors, dielectrics: factor on reflected light")                                \
    FIELD(specular_reflectance_g, "")                                                                                  \
    FIELD(specular_reflectance_b, "")                                                                                  \
    FIELD(specular_transmittance_r, "dielectrics: factor on transmitted light")                                        \
    FIELD(specular_transmittance_g, "")                                                                                \
    FIELD(specular_transmittance_b, "")                                                                                \
    FIELD(eta_r, "conductors: real part of the index, relative to the outside; eta = 0, k = 1 is a perfect mirror")    \
    FIELD(eta_g, "")                                                                                                   \
    FIELD(eta_b, "")                                                                                                   \
    FIELD(k_r, "conductors: imaginary part of the index, relative to the outside")                                     \
    FIELD(k_g, "")                                                                                                     \
    FIELD(k_b, "")                                                                                                     \
    FIELD(ior, "dielectrics: index inside over index outside (the normal points outside)")                             \
    FIELD(alpha_u, "rough kinds: roughness along the frame's s axis")                                                  \
    FIELD(alpha_v, "rough kinds: roughness along the frame's t axis")

/* KIND(name, is_delta): a BSDF kind is one program of the scatter stage and one bin of the wavefront.
 * kernels/lib/bsdf.h gives each kind name_eval, name_pdf, name_sample and name_albedo. */
#define GRADUS_BSDF_KINDS(KIND)                                                                                        \
    KIND(diffuse, 0)                                                                                                   \
    KIND(conductor, 1)                                                                                                 \
    KIND(dielectric, 1)                                                                                                \
    KIND(null, 1)                                                                                                      \
    KIND(roughconductor_ggx, 0)                                                                                        \
    KIND(roughconductor_beckmann, 0)                                                                                   \
    KIND(roughdielectric_ggx, 0)                                                                                       \
    KIND(roughdielectric_beckmann, 0)

GRADUS_LIB_BEGIN

#define GRADUS_FIELD_INDEX(name, text) material_##name,
enum material_field { GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_INDEX) material_stride };
#undef GRADUS_FIELD_INDEX

#define GRADUS_KIND_INDEX(name, is_delta) bsdf_kind_##name,
enum bsdf_kind { GRADUS_BSDF_KINDS(GRADUS_KIND_INDEX) bsdf_kind_count };
#undef GRADUS_KIND_INDEX

#define GRADUS_FIELD_MEMBER(name, text) real name;
typedef struct {
    GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_MEMBER)
} material;
#undef GRADUS_FIELD_MEMBER

/* Loads one record; fields that the caller does not use cost nothing once inlined. `unit` is 1, see FIELD_OF in
 * kernels/shared/scene_records.h. */
#define GRADUS_FIELD_LOAD(name, text) m.name = record[material_##name * (size_t)unit];
GRADUS_FN material material_load(GRADUS_GLOBAL const real *materials, uint index, uint unit) {
    GRADUS_GLOBAL const real *record = materials + (size_t)index * material_stride;
    material m;
    GRADUS_MATERIAL_FIELDS(GRADUS_FIELD_LOAD)
    return m;
}
#undef GRADUS_FIELD_LOAD

GRADUS_LIB_END
#endif
