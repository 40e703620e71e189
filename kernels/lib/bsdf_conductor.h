/* A smooth conductor, one-sided: mirror reflection times Fresnel. */
#ifndef GRADUS_LIB_BSDF_CONDUCTOR_H
#define GRADUS_LIB_BSDF_CONDUCTOR_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/fresnel.h"
#include "kernels/lib/ordered.h"

GRADUS_LIB_BEGIN

/* specular_reflectance times the Fresnel reflectance at the given cosine in [0, 1]. */
GRADUS_FN rgb conductor_reflectance(material m, real cosine) {
    const real r = fresnel_conductor(cosine, m.eta_r, m.k_r);
    const real g = fresnel_conductor(r_after(cosine, r), m.eta_g, m.k_g);
    const real b = fresnel_conductor(r_after(cosine, g), m.eta_b, m.k_b);
    return rgb_mul(material_specular_reflectance(m), rgb3(r, g, b));
}

GRADUS_FN bsdf_value conductor_evaluate(material m, vec3 wi, vec3 wo, int mode) {
    (void)m, (void)wi, (void)wo, (void)mode;
    return bsdf_value_none();
}

GRADUS_FN bsdf_sample conductor_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode) {
    (void)u_lobe, (void)u1, (void)u2, (void)mode;
    bsdf_sample sample;
    const real is_valid = wi.z > R(0) ? R(1) : R(0);
    sample.wo = v3(-wi.x, -wi.y, wi.z);
    sample.weight = rgb_scale(conductor_reflectance(m, r_clamp(wi.z, R(0), R(1))), is_valid);
    sample.pdf = is_valid;
    sample.pdf_reverse = is_valid;
    sample.eta = R(1);
    sample.lobe_weight = R(1);
    sample.is_specular = 1;
    return sample;
}

GRADUS_FN rgb conductor_albedo(material m) {
    return rgb_mul(material_specular_reflectance(m), rgb3(fresnel_mean(fresnel_conductor(R(1), m.eta_r, m.k_r)),
                                                          fresnel_mean(fresnel_conductor(R(1), m.eta_g, m.k_g)),
                                                          fresnel_mean(fresnel_conductor(R(1), m.eta_b, m.k_b))));
}

GRADUS_LIB_END
#endif
