/* A glossy lobe beside a diffuse one, a path taking one of them. */
#ifndef GRADUS_LIB_LOBE_SHARE_H
#define GRADUS_LIB_LOBE_SHARE_H
#include "kernels/lib/bsdf_sample.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/warp.h"

GRADUS_LIB_BEGIN

/* The glossy lobe's part of all that both reflect, at this very point. */
GRADUS_FN real lobe_share(rgb glossy, rgb diffuse) {
    const real of_glossy = glossy.r + glossy.g + glossy.b, of_diffuse = diffuse.r + diffuse.g + diffuse.b;
    return of_glossy / r_max(of_glossy + of_diffuse, R(1e-20));
}

/* Terms of a glossy lobe beside a diffuse one of albedo `reflectance`, sampled by lobe_share(). Both directions must be
 * above the horizon where is_valid. lobe_pdf: density of the glossy one, there and back; lobe: its f |cos wo| over
 * `specular_reflectance`. */
GRADUS_FN bsdf_terms lobe_beside_diffuse(material m, vec3 wi, vec3 wo, int is_valid, real lobe_pdf, real lobe) {
    bsdf_terms terms;
    const rgb specular = material_specular_reflectance(m), albedo = material_reflectance(m);
    const real share = lobe_share(specular, albedo);
    const real diffuse_pdf = warp_cosine_hemisphere_pdf(wo.z);
    const real pdf = share * lobe_pdf + (R(1) - share) * diffuse_pdf;
    terms.pdf = is_valid ? pdf : R(0);
    terms.pdf_reverse = is_valid ? share * lobe_pdf + (R(1) - share) * warp_cosine_hemisphere_pdf(wi.z) : R(0);
    const real inverse = terms.pdf > R(0) ? R(1) / r_max(pdf, R(1e-30)) : R(0);
    terms.weight = rgb_add(rgb_scale(albedo, diffuse_pdf * inverse), rgb_scale(specular, lobe * inverse));
    return terms;
}

/* The direction of a sample: of the glossy lobe, or of the diffuse one by u1 and u2. */
GRADUS_FN vec3 lobe_or_diffuse(material m, vec3 glossy, real u_lobe, real u1, real u2) {
    const vec3 scattered = warp_cosine_hemisphere(u1, r_after(u2, glossy.z));
    const real share = lobe_share(material_specular_reflectance(m), material_reflectance(m));
    return v3_select(u_lobe < share, glossy, scattered);
}

GRADUS_LIB_END
#endif
