/* What a microfacet surface does between two directions: which microfacet mirrors or refracts one into the other, and
 * the densities of visible normals that follow (Walter et al. 2007, eqs. 13 to 17). */
#ifndef GRADUS_LIB_MICROFACET_EVENT_H
#define GRADUS_LIB_MICROFACET_EVENT_H
#include "kernels/lib/microfacet.h"
#include "kernels/shared/material.h"

GRADUS_LIB_BEGIN

/* Reflection off the upper side, by the roughness of the material. */
typedef struct {
    vec3 from, to;         /* wi and wo; below the horizon as if above, which is_valid tells */
    real pdf, pdf_reverse; /* of wo, given wi; of wi, given wo */
    real masking;          /* G1(to) */
    real cosine;           /* between either and the microfacet's normal */
    int is_valid;
    GRADUS_NOT_IN_REGISTERS
} microfacet_mirror;

GRADUS_FN microfacet_mirror microfacet_mirror_of(material m, vec3 wi, vec3 wo, int distribution) {
    microfacet_mirror mirror;
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    mirror.is_valid = r_min(wi.z, wo.z) > R(0);
    mirror.from = v3(wi.x, wi.y, r_abs(wi.z));
    mirror.to = v3(wo.x, wo.y, r_abs(r_after(wo.z, mirror.from.z)));
    const vec3 h = v3_ordered(v3_add(mirror.from, mirror.to));
    const real length_squared = v3_dot(h, h);
    const real density = R(0.25) * microfacet_density(distribution, h, length_squared, alpha_u, alpha_v);
    mirror.pdf = density / microfacet_projected_area(distribution, mirror.from, alpha_u, alpha_v);
    const vec3 later = v3(r_after(mirror.to.x, mirror.pdf), r_after(mirror.to.y, mirror.pdf), mirror.to.z);
    const real area_to = microfacet_projected_area(distribution, later, alpha_u, alpha_v);
    mirror.pdf_reverse = density / area_to;
    mirror.masking = mirror.to.z / area_to;
    /* wi . m = |h| / 2 */
    mirror.cosine = r_min(R(0.5) * r_sqrt(length_squared), R(1));
    return mirror;
}

/* wo for a visible normal. Written as microfacet_mirror_of, so that what both compute from wi is computed once. */
GRADUS_FN vec3 microfacet_mirror_sample(material m, vec3 wi, real u1, real u2, int distribution) {
    const vec3 from = v3(wi.x, wi.y, r_abs(wi.z));
    const real alpha_u = microfacet_alpha(m.alpha_u);
    const real alpha_v = microfacet_alpha(r_after(m.alpha_v, alpha_u));
    const vec3 normal = microfacet_sample_visible(distribution, from, alpha_u, alpha_v, u1, u2);
    return v3_mad(v3_neg(from), R(2) * v3_dot(from, normal), normal);
}

/* Reflection or refraction, as wo's side says. */
typedef struct {
    vec3 h; /* along the normal, on the upper side */
    real length_squared, inverse_length;
    real from_cosine, to_cosine; /* to the normal; from_cosine is |h| / 2 for reflection, to the last bit */
    real eta;                    /* index on wo's side over the index on wi's side */
    real jacobian;               /* |wi.m| |wo.m| eta^2 / |h|^2, which is 1/4 exactly for reflection */
    int is_reflected;
    int is_sided; /* wi and the microfacet's front are on one side; wo is on the side that its lobe says */
    GRADUS_NOT_IN_REGISTERS
} microfacet_crossing;

/* from: above; to: on either side; eta_below: index below over the index above. */
GRADUS_FN microfacet_crossing microfacet_crossing_of(vec3 from, vec3 to, real eta_below) {
    microfacet_crossing crossing;
    crossing.is_reflected = to.z > R(0);
    crossing.eta = crossing.is_reflected ? R(1) : eta_below;
    const vec3 sum = v3_mad(from, crossing.eta, to);
    crossing.h = v3_scale(sum, r_copysign1(sum.z));
    crossing.length_squared = v3_dot(crossing.h, crossing.h);
    crossing.inverse_length = R(1) / r_sqrt(r_max(crossing.length_squared, R(1e-30)));
    crossing.from_cosine = crossing.is_reflected ? R(0.5) * crossing.length_squared * crossing.inverse_length
                                                 : v3_dot(from, crossing.h) * crossing.inverse_length;
    crossing.to_cosine = v3_dot(to, crossing.h) * crossing.inverse_length;
    const real refracted_jacobian = crossing.eta * crossing.eta * crossing.from_cosine * -crossing.to_cosine *
                                    crossing.inverse_length * crossing.inverse_length;
    crossing.jacobian = crossing.is_reflected ? R(0.25) : refracted_jacobian;
    crossing.is_sided = (crossing.from_cosine > R(0)) & ((crossing.to_cosine > R(0)) == crossing.is_reflected) &
                        (crossing.to_cosine != R(0)) & (to.z != R(0));
    return crossing;
}

GRADUS_LIB_END
#endif
