/* What a material's parameters are worth at a point of the surface where some are textures: of the materials of one
 * class (runtime/scene/material_class.h). CLASS_TEXTURED and CLASS_LOOKUPS are to it what TRAIT_TEXTURED and
 * TRAIT_LOOKUPS are to the scene; CLASS_ALL_TEXTURED has the parameters that all of its materials have as textures, and
 * TRAIT_TEXTURES is that of the class. parameter_texture is the first texture of the class. */
#ifndef GRADUS_LIB_MATERIAL_LOOKUP_H
#define GRADUS_LIB_MATERIAL_LOOKUP_H
//! traits: TRAIT_LOOKUPS TRAIT_TEXTURES
#include "kernels/lib/rough_coat.h"
#include "kernels/lib/texture_lookup.h"
#include "kernels/shared/material.h"
#include "kernels/shared/texture.h"

#define LOOKUP_PARAMETERS                                                                                              \
    , uint parameter_texture, GRADUS_GLOBAL const uint *textures, GRADUS_GLOBAL const real *texture_reals,             \
        GRADUS_GLOBAL const uint *texels, GRADUS_GLOBAL const uint *material_textures,                                 \
        GRADUS_GLOBAL const uint *material_lookups
#define LOOKUP_ARGUMENTS , parameter_texture, textures, texture_reals, texels, material_textures, material_lookups, unit

GRADUS_LIB_BEGIN

/* What texture number n of the material is worth here. */
#define LOOKED_UP(n)                                                                                                   \
    texture_lookup(TRAIT_TEXTURES, parameter_texture, textures, texture_reals, texels, unit,                           \
                   texture_or_first((material_lookups + (n) * (size_t)unit)[(int)(record * (uint)TRAIT_LOOKUPS)],      \
                                    parameter_texture),                                                                \
                   point)
#if CLASS_LOOKUPS == 0
#define CHOOSE_LOOKED_UP const rgb looked_up = rgb_gray(R(0));
#elif CLASS_LOOKUPS == 1
#define CHOOSE_LOOKED_UP const rgb looked_up = looked_up_0;
#elif CLASS_LOOKUPS == 2
#define CHOOSE_LOOKED_UP const rgb looked_up = rgb_select(number == 1u, looked_up_1, looked_up_0);
#elif CLASS_LOOKUPS == 3
#define CHOOSE_LOOKED_UP                                                                                               \
    const rgb looked_up = rgb_select(number == 2u, looked_up_2, rgb_select(number == 1u, looked_up_1, looked_up_0));
#else
/* Many: each where it is needed, so that they need not be kept. */
#define CHOOSE_LOOKED_UP const rgb looked_up = LOOKED_UP(is_constant ? 0u : number);
#endif
/* With a single lookup, which all materials take, there is nothing to ask. */
#define LOOK_UP(name)                                                                                                  \
    const int is_asked = (CLASS_LOOKUPS > 1) | !HAS_PARAMETER(CLASS_ALL_TEXTURED, name);                                \
    uint number = 0u;                                                                                                  \
    if (is_asked)                                                                                                      \
        number = (material_textures + parameter_##name * (size_t)unit)[(int)(record * (uint)textured_parameters)];     \
    const int is_constant = !HAS_PARAMETER(CLASS_ALL_TEXTURED, name) && number == texture_none;                        \
    CHOOSE_LOOKED_UP
#define TAKE_COLOR(with, name, value, text)                                                                            \
    if (HAS_PARAMETER(CLASS_TEXTURED, name)) {                                                                         \
        LOOK_UP(name)                                                                                                  \
        m.name##_r = is_constant ? m.name##_r : looked_up.r;                                                           \
        m.name##_g = is_constant ? m.name##_g : looked_up.g;                                                           \
        m.name##_b = is_constant ? m.name##_b : looked_up.b;                                                           \
    }
/* Of a coloured texture its luminance. */
#define TAKE_NUMBER(with, name, value, text)                                                                           \
    if (HAS_PARAMETER(CLASS_TEXTURED, name)) {                                                                         \
        LOOK_UP(name)                                                                                                  \
        m.name = is_constant ? m.name : rgb_luminance(looked_up);                                                      \
    }

/* The material of `record` with what its textures are worth at the point. */
GRADUS_FN material material_looked_up(GRADUS_GLOBAL const real *materials, uint record,
                                      texture_point point LOOKUP_PARAMETERS, uint unit) {
    material m = material_load(materials, record, unit);
    (void)material_textures;
#if CLASS_LOOKUPS >= 1 && CLASS_LOOKUPS <= 3
    const rgb looked_up_0 = LOOKED_UP(0u);
#if CLASS_LOOKUPS >= 2
    const rgb looked_up_1 = LOOKED_UP(1u);
#endif
#if CLASS_LOOKUPS == 3
    const rgb looked_up_2 = LOOKED_UP(2u);
#endif
#endif
    GRADUS_LOOKED_UP_PARAMETERS(TAKE_COLOR, TAKE_NUMBER, )
    if (HAS_PARAMETER(CLASS_TEXTURED, coat_0))
        m = rough_coat_of(m, materials, unit);
    return m;
}

GRADUS_LIB_END
#endif
