/* Rough coats whose roughness is a texture. What follows from it, internal_reflectance and coat_0 to coat_9, the host
 * knows of rough_coat_records roughnesses (runtime/scene/coating.h): material records of their own, one after the other
 * from number coat_records on. Between them it is linear, to a
 * thousandth or so, as the polynomials themselves are. */
#ifndef GRADUS_LIB_ROUGH_COAT_H
#define GRADUS_LIB_ROUGH_COAT_H
#include "kernels/shared/material.h"

GRADUS_LIB_BEGIN

#define rough_coat_records 32u
/* Half of them are smoother than this. */
#define ROUGH_COAT_MIDDLE R(0.25)

/* Record i has this roughness: 0 to 7.75, the closer to each other the smoother. */
GRADUS_FN real rough_coat_roughness(uint i) { return ROUGH_COAT_MIDDLE * (real)i / (real)(rough_coat_records - i); }

/* Its inverse, from 0 on. */
GRADUS_FN real rough_coat_place(real roughness) {
    return (real)rough_coat_records * (roughness / (roughness + ROUGH_COAT_MIDDLE));
}

#define MIX_ROUGH_COAT(with, name, value, text)                                                                        \
    m.name = has_records ? one.name + share * (other.name - one.name) : m.name;

/* A material with what its coat makes of its alpha_u; above the last roughness as at that. Unchanged where
 * coat_records is 0; there must be rough_coat_records records all the same. */
GRADUS_FN material rough_coat_of(material m, GRADUS_GLOBAL const real *materials, uint unit) {
    const int has_records = m.coat_records > R(0);
    const real place = r_clamp(rough_coat_place(m.alpha_u), R(0), (real)(rough_coat_records - 1u));
    const real below = r_min(r_floor(place), (real)(rough_coat_records - 2u)), share = place - below;
    const uint first = (uint)(m.coat_records + below);
    const material one = material_load(materials, first, unit), other = material_load(materials, first + 1u, unit);
    GRADUS_COAT_PARAMETERS(MIX_ROUGH_COAT, )
    return m;
}
#undef MIX_ROUGH_COAT

GRADUS_LIB_END
#endif
