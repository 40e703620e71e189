/* photon_pass: what the vertices of one kind, or all specular ones, make of the light of chains that have come to their
 * new ends: the factor on the power, and the density of the direction, by solid angle, or the probability of the event
 * over that at the base's vertex. Then (LAST_KIND) the chain's last ray is left in `moved`, as if it had been sent out;
 * nothing is where the walk has not arrived. */
//! traits: TRAIT_SHADING_NORMALS
#include "kernels/lib/bsdf.h"
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/photon_chain.h"
#include "kernels/lib/ray_start.h"
#include "kernels/lib/vertex_frame.h"

#if !LAST_KIND
STAGE photon_pass(uint count, uint unit, uint first, uint pairs, uint photon_rows, uint pair_rows, uint chain_bin,
                  uint chain_rows, uint chain_vertices, __global const uint *moved_index,
                  __global const uint *pair_photon, __global const real *photon_sorted,
                  __global const real *light_vertices, __global const uint *light_vertex_marks,
                  __global const uint *leaving_bin, __global const real *materials, __global real *moved,
                  __global const real *chain, __global const real *walked, __global const real *walked_vertex) {
    const size_t i = work_item();
    if (i >= count || AT_UINT(walked, outcome, i) != walk_arrived)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    uint record = AT_UINT(photon_sorted, before, pair_photon[pair]);
    vec3 next = AT_V3(chain, target, i);
    rgb power = AT_RGB(moved, power, to);
    real ratio = AT(moved, ratio, to);
    for (uint k = AT_UINT(chain, inner, i); k > 0u; --k) {
        const size_t vertex = (size_t)(k - 1u) * chain_rows + i;
        const vec3 position = AT_V3(walked_vertex, position, vertex);
        const uint kind = AT_UINT(walked_vertex, kind, vertex);
#if BSDF_IS_DIRAC
        const int is_served = (kind & kind_is_dirac) != 0u; /* whichever of them it is */
#else
        const int is_served = kind_number(kind) == PASTE(bsdf_kind_, BSDF);
#endif
        if (is_served) {
            const vec3 out = v3_normalize(v3_sub(next, position)), back = AT_V3(walked_vertex, wi, vertex);
            const uint there = AT_UINT(walked_vertex, material, vertex);
            const material m = material_load(materials, there, unit);
            const frame axes = VERTEX_FRAME(walked_vertex, vertex, m);
            const vec3 wi = frame_to_local(axes, back), wo = frame_to_local(axes, out);
#if BSDF_IS_DIRAC
            const int is_reflected = wi.z * wo.z > R(0);
            /* Below and above all reflectances: where there is a choice, the event is given. */
            const bsdf_sample s =
                PASTE(BSDF, _sample)(m, wi, is_reflected ? R(-1) : R(2), R(0), R(0), transport_importance);
            const int is_that = ((s.wo.z * wi.z > R(0)) == is_reflected) & (s.is_specular != 0);
            bsdf_value f;
            f.pdf = is_that ? s.pdf : R(0);
            f.value = rgb_scale(s.weight, f.pdf);
#else
            bsdf_value f = PASTE(BSDF, _evaluate)(m, wi, wo, transport_importance);
            f.pdf = leaving_bin[there] == chain_bin ? f.pdf : R(0); /* or no walk would lead back */
#endif
            real turned = R(1);
#if TRAIT_SHADING_NORMALS
            const vec3 geometric = AT_V3(walked_vertex, geometric, vertex);
            turned = r_abs(wi.z * v3_dot(geometric, out)) / r_max(r_abs(v3_dot(geometric, back) * wo.z), R(1e-12));
#endif
            const real pdf = FIELD_OF(light_vertex, light_vertices, record, pdf);
            const real inverse_pdf = f.pdf > R(0) ? R(1) / r_max(pdf, R(1e-30)) : R(0);
            const real survival = FIELD_OF(light_vertex, light_vertices, record, survival);
            power = rgb_scale(rgb_mul(power, f.value), inverse_pdf * turned / r_max(survival, R(1e-30)));
            ratio *= f.pdf * inverse_pdf;
        }
        next = position;
        record = FIELD_OF(light_vertex_mark, light_vertex_marks, record, before);
    }
    SET_RGB(moved, power, to, power);
    AT(moved, ratio, to) = ratio;
}
#else
STAGE photon_pass(uint count, uint unit, uint first, uint pair_rows, uint chain_rows, uint chain_vertices,
                  __global real *moved, __global const real *chain, __global const real *walked,
                  __global const real *walked_vertex) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint inner = AT_UINT(chain, inner, i);
    const int arrived = AT_UINT(walked, outcome, i) == walk_arrived;
    const size_t vertex = (size_t)(arrived ? inner - 1u : 0u) * chain_rows + i;
    const vec3 position = AT_V3(walked_vertex, position, vertex);
    const vec3 way = v3_sub(AT_V3(chain, target, i), position);
    const vec3 direction = v3_scale(way, R(1) / r_sqrt(r_max(v3_dot(way, way), R(1e-30))));
    const vec3 origin =
        ray_origin(position, AT_V3(walked_vertex, geometric, vertex), AT(walked_vertex, offset, vertex), direction);
    const int works = arrived & (rgb_max(AT_RGB(moved, power, to)) > R(0));
    SET_V3(moved, origin, to, origin);
    SET_V3(moved, direction, to, direction);
    AT_UINT(moved, primitive, to) = works ? AT_UINT(moved, primitive, to) : ray_none;
}
#endif
