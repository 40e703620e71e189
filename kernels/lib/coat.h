/* A diffuse base under a dielectric coat, as plastics are: what comes out of the base again.
 *
 * Light passes the coat, is scattered by the base, and of what comes back the share `internal_reflectance` is thrown
 * back by the coat from within, each time to be scattered anew. The sum of that series is, with the base's albedo r and
 * the transmittance T of the coat at either direction,
 *     f cos = r / (1 - internal_reflectance r) T(wi) T(wo) cos / (pi ior^2).
 * Unless `nonlinear`, the r in the denominator is left out, as in Mitsuba: then saturation does not change by it. */
#ifndef GRADUS_LIB_COAT_H
#define GRADUS_LIB_COAT_H
#include "kernels/lib/bsdf_sample.h"

GRADUS_LIB_BEGIN

GRADUS_FN real coat_base_channel(real albedo, material m) {
    const real scattered_again = m.internal_reflectance * (R(1) + m.nonlinear * (albedo - R(1)));
    return albedo / (r_max(R(1) - scattered_again, R(1e-4)) * m.ior * m.ior);
}

/* r / (1 - ...) / ior^2 of each channel: at most 1 once it is multiplied by both transmittances. */
GRADUS_FN rgb coat_base(material m) {
    return rgb3(coat_base_channel(m.reflectance_r, m), coat_base_channel(m.reflectance_g, m),
                coat_base_channel(m.reflectance_b, m));
}

/* The probability to sample the coat's reflection and not the base, for a path that the coat reflects this much of. Any
 * is right, but 0 where the coat reflects; it goes by how bright both are at this very point. */
GRADUS_FN real coat_chance(real reflectance, rgb specular, rgb albedo) {
    const real coat = reflectance * (specular.r + specular.g + specular.b);
    const real base = (R(1) - reflectance) * (albedo.r + albedo.g + albedo.b);
    return coat / r_max(coat + base, R(1e-20));
}

GRADUS_LIB_END
#endif
