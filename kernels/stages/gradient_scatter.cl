/* gradient_scatter: samples the BSDF of each second vertex of one kind (rows `first` on) and leaves the next ray. Here
 * the offset paths that have come this far merge with the base path: all that follows is the same for both. What came
 * before is kept by slot, and the base path goes on with a throughput of its own, so that the later stages are those of
 * the path tracer and know nothing of offset paths. */
//! traits: TRAIT_REFRACTION
#include "kernels/lib/bsdf.h"
#include "kernels/lib/random.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE gradient_scatter(uint count, uint unit, uint first, uint capacity, uint slots, uint max_depth,
                       uint roulette_depth, __global real *vertex, __global const real *tangent, __global real *ray,
                       __global const real *shifted, __global real *prefix, __global real *difference,
                       __global const real *materials) {
    const size_t i = get_global_id(0);
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row), slot = AT_UINT(vertex, slot, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_scatter(depth));
    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, u.a, u.b, u.c);
    const rgb throughput = rgb_mul(AT_RGB(vertex, throughput, row), s.weight);
    real brightest = rgb_max(throughput);
#if !BSDF_IS_DIRAC
    const real inverse_pdf = s.pdf > R(0) ? R(1) / s.pdf : R(0);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row, to = (size_t)j * slots + slot;
        const real ratio = AT(shifted, ratio, at);
        const vec3 offset_wi = frame_to_local(axes, AT_V3(shifted, wi, at));
        const real factor = ratio >= R(0) ? inverse_pdf : R(0);
        const rgb value =
            rgb_scale(rgb_mul(AT_RGB(shifted, value, at), PASTE(BSDF, _eval)(m, offset_wi, s.wo)), factor);
        const real next_ratio = ratio * PASTE(BSDF, _pdf)(m, offset_wi, s.wo) * factor;
        SET_RGB(difference, throughput, to, value);
        AT(difference, ratio, to) = ratio < R(0) ? ratio : next_ratio;
        brightest = r_max(brightest, rgb_max(value));
    }
#else
#pragma unroll
    for (uint j = 0; j < 4; ++j)
        AT(difference, ratio, (size_t)j * slots + slot) = AT(shifted, ratio, (size_t)j * capacity + row);
#endif

    real eta = R(1);
#if TRAIT_REFRACTION
    eta = AT(vertex, eta, row) * s.eta;
    AT(vertex, eta, row) = eta;
#endif
    const real survival = depth + 1u >= roulette_depth ? r_min(brightest * eta * eta, R(0.95)) : R(1);
    const int alive = depth + 1u < max_depth && s.pdf > R(0) && brightest > R(0) && u.d < survival;
    /* From here on the row's throughput counts from 1, but for its size, which roulette goes by; the slot has the
     * rest. */
    const real inverse = R(1) / (alive ? brightest : R(1));
    SET_RGB(prefix, throughput, slot, rgb_scale(throughput, inverse));
#if !BSDF_IS_DIRAC
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t to = (size_t)j * slots + slot;
        AT(difference, throughput_r, to) *= inverse;
        AT(difference, throughput_g, to) *= inverse;
        AT(difference, throughput_b, to) *= inverse;
    }
#endif

    const vec3 direction = v3_normalize(frame_to_world(axes, s.wo));
    const vec3 origin =
        ray_origin(AT_V3(vertex, position, row), AT_V3(vertex, geometric, row), AT(vertex, offset, row), direction);
    AT_UINT(vertex, depth, row) = depth + 1u;
    SET_RGB(vertex, throughput, row, rgb_gray(alive ? brightest / survival : R(0)));
    AT(vertex, pdf, row) = BSDF_IS_DIRAC ? R(0) : s.pdf;
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, direction);
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
}
