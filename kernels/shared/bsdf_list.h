/* The one list of BSDF kinds, and of the parameters that materials have, for host and device. It holds macros alone, so
 * that any file may include it; what follows from it needs no list of its own: the records and enumerations of
 * kernels/shared/material.h, what kernels/lib/bsdf.h includes, Bsdf (runtime/scene/scene.h), its traits, its names. */
#ifndef GRADUS_SHARED_BSDF_LIST_H
#define GRADUS_SHARED_BSDF_LIST_H

/* COLOR(WITH, name, default, what it is) and NUMBER(WITH, ...): the parameters of all kinds, first those for which a
 * texture may stand. A kind ignores those that it does not name. Colours are unitless linear RGB. WITH is handed on as
 * it is. */
#define GRADUS_LOOKED_UP_PARAMETERS(COLOR, NUMBER, WITH)                                                               \
    COLOR(WITH, reflectance, 0.5f, "albedo")                                                                           \
    COLOR(WITH, specular_reflectance, 1, "factor on reflected light")                                                  \
    COLOR(WITH, specular_transmittance, 1, "factor on transmitted light")                                              \
    NUMBER(WITH, alpha_u, 0.1f, "roughness along the frame's s axis")                                                  \
    NUMBER(WITH, alpha_v, 0.1f, "roughness along the frame's t axis")                                                  \
    NUMBER(WITH, facet_alpha, 0.2f, "roughness of a surface of diffuse facets")                                        \
    NUMBER(WITH, exponent, 30, "of Phong's lobe")                                                                      \
    NUMBER(WITH, roughness, 0.5f, "its square is the roughness of the microfacets")                                    \
    NUMBER(WITH, anisotropic, 0, "0 to 1: how much rougher they are along one axis")                                   \
    NUMBER(WITH, metallic, 0, "share of metal against dielectric")                                                     \
    NUMBER(WITH, spec_trans, 0, "share of light that a dielectric lets pass against what it scatters")                 \
    NUMBER(WITH, spec_tint, 0, "how much reflections have the base colour")                                            \
    NUMBER(WITH, sheen, 0, "reflection at grazing angles, as of cloth")                                                \
    NUMBER(WITH, sheen_tint, 0, "how much the sheen has the base colour")                                              \
    NUMBER(WITH, flatness, 0, "share of light that is scattered as if below the surface")                              \
    NUMBER(WITH, clearcoat, 0, "how much a second, clear coat reflects")                                               \
    NUMBER(WITH, clearcoat_gloss, 0, "how smooth that coat is")                                                        \
    NUMBER(WITH, diff_trans, 0, "share of diffuse light that passes a thin surface, 0 to 2")
/* Those that vary where roughness does: kernels/lib/rough_coat.h. */
#define GRADUS_COAT_PARAMETERS(NUMBER, WITH)                                                                           \
    NUMBER(WITH, internal_reflectance, 0, "of a coat from within, for diffuse light; follows from ior and roughness")  \
    NUMBER(WITH, coat_0, 1, "and on to coat_9: the coat's transmittance, a polynomial; follows likewise")              \
    NUMBER(WITH, coat_1, 0, "")                                                                                        \
    NUMBER(WITH, coat_2, 0, "")                                                                                        \
    NUMBER(WITH, coat_3, 0, "")                                                                                        \
    NUMBER(WITH, coat_4, 0, "")                                                                                        \
    NUMBER(WITH, coat_5, 0, "")                                                                                        \
    NUMBER(WITH, coat_6, 0, "")                                                                                        \
    NUMBER(WITH, coat_7, 0, "")                                                                                        \
    NUMBER(WITH, coat_8, 0, "")                                                                                        \
    NUMBER(WITH, coat_9, 0, "")
#define GRADUS_TEXTURED_PARAMETERS(COLOR, NUMBER, WITH)                                                                \
    GRADUS_LOOKED_UP_PARAMETERS(COLOR, NUMBER, WITH) GRADUS_COAT_PARAMETERS(NUMBER, WITH)
/* Those that no texture can stand for. */
#define GRADUS_PLAIN_PARAMETERS(COLOR, NUMBER, WITH)                                                                   \
    COLOR(WITH, eta, 0, "real part of the index, relative to the outside; eta = 0, k = 1 is a perfect mirror")         \
    COLOR(WITH, k, 1, "imaginary part of the index, relative to the outside")                                          \
    NUMBER(WITH, ior, 1.5046f, "index inside over index outside (the normal points outside)")                          \
    NUMBER(WITH, nonlinear, 0, "1: colours shift by what is scattered under a coat more than once")                    \
    NUMBER(WITH, coat_records, 0, "records of this coat at other roughnesses (kernels/lib/rough_coat.h); 0: none")     \
    NUMBER(WITH, pane_ior, 1.5046f, "index of a thin pane over that around it")                                        \
    NUMBER(WITH, fast_approximation, 0, "1: the simpler model of diffuse facets")                                      \
    NUMBER(WITH, ward_variant, 2, "of Ward's lobe: 0 as published, 1 after Duer, 2 balanced")
#define GRADUS_MATERIAL_PARAMETERS(COLOR, NUMBER, WITH)                                                                \
    GRADUS_TEXTURED_PARAMETERS(COLOR, NUMBER, WITH) GRADUS_PLAIN_PARAMETERS(COLOR, NUMBER, WITH)

/* KIND(name, lobes, transmits, parameters): a BSDF kind is one program of the stages that evaluate BSDFs, and one bin
 * of the wavefront. lobes: 0, rough ones; 1, Dirac lobes alone, which light sampling cannot meet; the Dirac kinds of a
 * scene share a program (kernels/lib/bsdf_specular.h); 2, a Dirac lobe that mirrors, beside rough ones: evaluation
 * gives the rough ones, a sample says which it is, and u_lobe below 0 asks for the Dirac one. transmits: light passes
 * it, so it has both sides by nature; where it has an `ior` too, it refracts. A kind with `alpha_u` has that roughness.
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
    KIND(roughdielectric_beckmann, 0, 1, "specular_reflectance specular_transmittance ior alpha_u alpha_v")            \
    KIND(plastic, 2, 0, "reflectance specular_reflectance ior nonlinear internal_reflectance")                         \
    KIND(roughplastic_ggx, 0, 0, "reflectance specular_reflectance ior alpha_u alpha_v " GRADUS_ROUGH_COAT)            \
    KIND(roughplastic_beckmann, 0, 0, "reflectance specular_reflectance ior alpha_u alpha_v " GRADUS_ROUGH_COAT)       \
    KIND(thindielectric, 1, 1, "specular_reflectance specular_transmittance pane_ior")                                 \
    KIND(roughdiffuse, 0, 0, "reflectance facet_alpha fast_approximation")                                             \
    KIND(phong, 0, 0, "reflectance specular_reflectance exponent alpha_u alpha_v")                                     \
    KIND(ward, 0, 0, "reflectance specular_reflectance alpha_u alpha_v ward_variant")                                  \
    KIND(principled, 0, 0, "reflectance ior metallic clearcoat clearcoat_gloss " GRADUS_PRINCIPLED)                    \
    KIND(principled_clear, 0, 1, "reflectance ior metallic clearcoat clearcoat_gloss spec_trans " GRADUS_PRINCIPLED)   \
    KIND(principledthin, 0, 1, "reflectance ior diff_trans spec_trans " GRADUS_PRINCIPLED)
/* alpha_u and alpha_v follow from roughness and anisotropic, which their kernels read; frames go by whether they
 * differ. */
#define GRADUS_PRINCIPLED "alpha_u alpha_v roughness anisotropic spec_tint sheen sheen_tint flatness"
#define GRADUS_ROUGH_COAT                                                                                              \
    "nonlinear internal_reflectance coat_0 coat_1 coat_2 coat_3 coat_4 coat_5 coat_6 coat_7 coat_8 coat_9 "            \
    "coat_records"

/* FIELD(name): the reals of a material's record; `bsdf` is the number of its kind. */
#define GRADUS_COLOR_FIELDS(FIELD, name, value, text) FIELD(name##_r) FIELD(name##_g) FIELD(name##_b)
#define GRADUS_NUMBER_FIELD(FIELD, name, value, text) FIELD(name)
#define GRADUS_MATERIAL_FIELDS(FIELD)                                                                                  \
    GRADUS_MATERIAL_PARAMETERS(GRADUS_COLOR_FIELDS, GRADUS_NUMBER_FIELD, FIELD) FIELD(bsdf)

#endif
