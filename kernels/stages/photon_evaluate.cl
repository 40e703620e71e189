/* photon_evaluate: what pairs of a gather point of one BSDF kind and a photon are worth: f power, f without its cosine.
 *
 * A photon's flux is what arrives at the surface as it is, so the value |cos| of the BSDF, which is by the shading
 * normal, is divided by the cosine to the geometric normal (Veach 1997, 5.3), that of the facet on which the photon
 * landed: by the gather point's own, photons of a neighbouring facet would count by what that one is tilted. */
#include "kernels/lib/bsdf_evaluate.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE photon_evaluate(uint count, uint unit, uint capacity, uint photon_rows, uint pair_rows,
                      __global const uint *pair_gather, __global const uint *pair_photon, __global const real *gather,
                      __global const real *photon_sorted, __global const real *materials, __global real *pair_value) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint row = pair_gather[i], from = pair_photon[i];
    const material m = material_load(materials, AT_UINT(gather, material, row), unit);
    const frame axes = VERTEX_FRAME(gather, row, m);
    const vec3 wi = AT_V3(gather, wi, row), wo = AT_V3(photon_sorted, wi, from);
    const rgb power = AT_RGB(photon_sorted, power, from);
    const bsdf_value v = bsdf_evaluate(m, frame_to_local(axes, wi), frame_to_local(axes, wo));
    const real cosine = r_abs(v3_dot(wo, AT_V3(photon_sorted, normal, from)));
    /* A photon that grazes the surface carries no flux to speak of. */
    const real inverse = cosine > R(1e-6) ? R(1) / r_max(cosine, R(1e-6)) : R(0);
    const rgb value = rgb_scale(rgb_mul(v.value, power), inverse);
    SET_RGB(pair_value, value, i, value);
}
