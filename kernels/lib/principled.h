/* What the principled models share (Burley 2012, 2015), in the forms of Mitsuba 3. Their base colour is `reflectance`,
 * their index `ior`. */
#ifndef GRADUS_LIB_PRINCIPLED_H
#define GRADUS_LIB_PRINCIPLED_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/microfacet_event.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

/* (1 - cosine)^5, Schlick's (1994). */
GRADUS_FN real schlick_weight(real cosine) {
    const real x = r_clamp(R(1) - cosine, R(0), R(1));
    const real squared = x * x;
    return squared * squared * x;
}

GRADUS_FN real principled_mix(real a, real b, real share) { return a + share * (b - a); }

GRADUS_FN rgb rgb_mix(rgb a, rgb b, real share) {
    return rgb3(principled_mix(a.r, b.r, share), principled_mix(a.g, b.g, share), principled_mix(a.b, b.b, share));
}

/* The base colour at luminance 1; white where it is black. */
GRADUS_FN rgb principled_tint(rgb base) {
    const real luminance = rgb_luminance(base);
    return rgb_select(luminance > R(0), rgb_scale(base, R(1) / r_max(luminance, R(1e-20))), rgb_gray(R(1)));
}

/* GGX's alpha along both axes. */
typedef struct {
    real u, v;
    GRADUS_NOT_IN_REGISTERS
} principled_alpha;

GRADUS_FN principled_alpha principled_alpha_of(real roughness, real anisotropic) {
    principled_alpha alpha;
    const real squared = roughness * roughness;
    const real aspect = r_sqrt(r_max(R(1) - R(0.9) * anisotropic, R(0.1)));
    alpha.u = r_max(squared / aspect, R(0.001));
    alpha.v = r_max(r_after(squared, alpha.u) * aspect, R(0.001));
    return alpha;
}

/* The diffuse lobe's f |cos to| for the base colour 1, with retroreflection, or as if light were scattered below the
 * surface, by `flatness`. `middle`: the cosine between half vector and either direction. */
GRADUS_FN real principled_diffuse(material m, real from, real to, real middle) {
    const real weight_from = schlick_weight(from), weight_to = schlick_weight(r_after(to, weight_from));
    const real plain = (R(1) - R(0.5) * weight_from) * (R(1) - R(0.5) * weight_to);
    const real back = R(2) * m.roughness * middle * middle;
    const real retro = back * (weight_to + weight_from + weight_to * weight_from * (back - R(1)));
    const real at_grazing = R(0.5) * back;
    const real both = principled_mix(R(1), at_grazing, weight_to) * principled_mix(R(1), at_grazing, weight_from);
    const real below = R(1.25) * (both * (R(1) / r_max(to + from, R(1e-6)) - R(0.5)) + R(0.5));
    return principled_mix(plain + retro, below, m.flatness) * warp_cosine_hemisphere_pdf(to);
}

/* The sheen's f |cos to|. */
GRADUS_FN rgb principled_sheen(material m, rgb tint, real to, real middle) {
    return rgb_scale(rgb_mix(rgb_gray(R(1)), tint, m.sheen_tint), m.sheen * schlick_weight(middle) * to);
}

/* The tinted part of the reflectance of an interface: Schlick's curve over the tinted reflectance at normal incidence.
 * Where the index falls the curve goes by the refracted ray. */
GRADUS_FN real principled_curve(real cosine, real cosine_transmitted, real eta) {
    return schlick_weight(eta > R(1) ? cosine : cosine_transmitted);
}
GRADUS_FN rgb principled_schlick(rgb at_normal, real curve) { return rgb_mix(at_normal, rgb_gray(R(1)), curve); }

GRADUS_LIB_END
#endif
