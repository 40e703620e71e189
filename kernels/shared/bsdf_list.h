/* The one list of BSDF kinds, and of the parameters that materials have, for host and device. It holds macros alone, so
 * that any file may include it; what follows from it needs no list of its own: the records and enumerations of
 * kernels/shared/material.h, what kernels/lib/bsdf.h includes, Bsdf (runtime/scene/scene.h), its traits, its names. */
#ifndef GRADUS_SHARED_BSDF_LIST_H
#define GRADUS_SHARED_BSDF_LIST_H

/* COLOR(WITH, name, default, what it is) and NUMBER(WITH, ...): the parameters of all kinds. A kind ignores those that
 * it does not name. Colours are unitless linear RGB. WITH is handed on as it is. */
#define GRADUS_MATERIAL_PARAMETERS(COLOR, NUMBER, WITH)                                                                \
    COLOR(WITH, reflectance, 0.5f, "albedo")                                                                           \
    COLOR(WITH, specular_reflectance, 1, "factor on reflected light")                                                  \
    COLOR(WITH, specular_transmittance, 1, "factor on transmitted light")                                              \
    COLOR(WITH, eta, 0, "real part of the index, relative to the outside; eta = 0, k = 1 is a perfect mirror")         \
    COLOR(WITH, k, 1, "imaginary part of the index, relative to the outside")                                          \
    NUMBER(WITH, ior, 1.5046f, "index inside over index outside (the normal points outside)")                          \
    NUMBER(WITH, alpha_u, 0.1f, "roughness along the frame's s axis")                                                  \
    NUMBER(WITH, alpha_v, 0.1f, "roughness along the frame's t axis")

/* KIND(name, is_dirac, transmits, parameters): a BSDF kind is one program of the stages that evaluate BSDFs, and one
 * bin of the wavefront. is_dirac: it has Dirac lobes alone, which light sampling cannot meet; the Dirac kinds of a
 * scene share a program (kernels/lib/bsdf_specular.h). transmits: light passes it, so it has both sides by nature;
 * where it has an `ior` too, it refracts. A kind with `alpha_u` has that roughness.
 *
 * Its functions are in kernels/lib/bsdf_<name>.h, or, where kinds share a file, in that of the name without its last
 * word. One a line, as here: kernels/CMakeLists.txt reads this list too. */
#define GRADUS_BSDF_KINDS(KIND)                                                                                        \
    KIND(diffuse, 0, 0, "reflectance")                                                                                 \
    KIND(conductor, 1, 0, "specular_reflectance eta k")                                                                \
    KIND(dielectric, 1, 1, "specular_reflectance specular_transmittance ior")                                          \
    KIND(null, 1, 1, "")                                                                                               \
    KIND(roughconductor_ggx, 0, 0, "specular_reflectance eta k alpha_u alpha_v")                                       \
    KIND(roughconductor_beckmann, 0, 0, "specular_reflectance eta k alpha_u alpha_v")                                  \
    KIND(roughdielectric_ggx, 0, 1, "specular_reflectance specular_transmittance ior alpha_u alpha_v")                 \
    KIND(roughdielectric_beckmann, 0, 1, "specular_reflectance specular_transmittance ior alpha_u alpha_v")

/* FIELD(name): the reals of a material's record; `bsdf` is the number of its kind. */
#define GRADUS_COLOR_FIELDS(FIELD, name, value, text) FIELD(name##_r) FIELD(name##_g) FIELD(name##_b)
#define GRADUS_NUMBER_FIELD(FIELD, name, value, text) FIELD(name)
#define GRADUS_MATERIAL_FIELDS(FIELD)                                                                                  \
    GRADUS_MATERIAL_PARAMETERS(GRADUS_COLOR_FIELDS, GRADUS_NUMBER_FIELD, FIELD) FIELD(bsdf)

#endif
