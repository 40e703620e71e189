/* scatter: samples the BSDF of each vertex of one kind (rows `first` on) and leaves the next ray, or ends the path:
 * where the sample fails, the throughput is zero, the path is as long as it may be, or Russian roulette says so. */
//! traits: TRAIT_REFRACTION
#include "kernels/lib/bsdf.h"
#include "kernels/lib/random.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE scatter(uint count, uint unit, uint first, uint capacity, uint max_depth, uint roulette_depth,
              __global real *vertex, __global const real *tangent, __global real *ray, __global const real *materials) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_scatter(depth));
    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, u.a, u.b, u.c, transport_radiance);

    rgb throughput = rgb_mul(AT_RGB(vertex, throughput, row), s.weight);
    real eta = R(1);
#if TRAIT_REFRACTION
    eta = AT(vertex, eta, row) * s.eta;
    AT(vertex, eta, row) = eta;
#endif
    /* Mitsuba's rule: survive with the largest throughput, freed of the radiance scaling by eta^2, at most 0.95. */
    real survival = depth + 1u >= roulette_depth ? r_min(rgb_max(throughput) * eta * eta, R(0.95)) : R(1);
    int alive = depth + 1u < max_depth && s.pdf > R(0);
#ifdef KEEP_DARK
    /* A black path may have offset paths that are not: it must go on. No roulette at its first vertex. */
    survival = R(1);
#else
    alive = alive && rgb_max(throughput) > R(0) && u.d < survival;
#endif
    throughput = rgb_scale(throughput, R(1) / (alive ? survival : R(1)));

    const vec3 direction = v3_normalize(frame_to_world(axes, s.wo));
    const vec3 origin =
        ray_origin(AT_V3(vertex, position, row), AT_V3(vertex, geometric, row), AT(vertex, offset, row), direction);
    AT_UINT(vertex, depth, row) = depth + 1u;
    SET_RGB(vertex, throughput, row, throughput);
    AT(vertex, pdf, row) = BSDF_IS_DIRAC ? R(0) : s.pdf;
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, direction);
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
}
