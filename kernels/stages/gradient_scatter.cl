/* gradient_scatter: samples the BSDF of each vertex of one kind (rows `first` on) and leaves the next ray. Offset paths
 * that have reconnected merge with the base path here: all that follows is the same for both.
 *
 * Where that is so of all, what came before is kept by slot, and the base path goes on with a throughput of its own, so
 * that the later stages are those of the path tracer and know nothing of offset paths. APART: where some may still be
 * apart, all stay in `shifted`. */
//! traits: TRAIT_REFRACTION
#include "kernels/lib/bsdf.h"
#include "kernels/lib/random.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE gradient_scatter(uint count, uint unit, uint first, uint capacity, uint slots, uint max_depth,
                       uint roulette_depth, __global real *vertex, __global const real *tangent, __global real *ray,
                       __global real *shifted, __global real *prefix, __global real *difference,
                       __global const real *materials) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row), slot = AT_UINT(vertex, slot, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_scatter(depth));
    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, u.a, u.b, u.c, transport_radiance);
    const rgb throughput = rgb_mul(AT_RGB(vertex, throughput, row), s.weight);
    real brightest = rgb_max(throughput);
    const real inverse_pdf = s.pdf > R(0) ? R(1) / s.pdf : R(0);
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const real ratio = AT(shifted, ratio, at);
        const rgb so_far = AT_RGB(shifted, value, at);
#if BSDF_IS_DIRAC
        /* Only those that merged before come to a Dirac vertex. */
        (void)inverse_pdf;
        const rgb weight = s.weight;
        const real change = R(1);
#else
        const vec3 offset_wi = frame_to_local(axes, AT_V3(shifted, wi, at));
        const bsdf_value f = PASTE(BSDF, _evaluate)(m, offset_wi, s.wo, transport_radiance);
        const rgb weight = rgb_scale(f.value, inverse_pdf);
        const real change = f.pdf * inverse_pdf;
#endif
        /* Selected, not scaled: where there is no offset path, its direction is anything. */
        const int is_there = ratio >= R(0);
        const rgb weighted = rgb_mul(so_far, weight);
        const rgb merged =
            rgb3(is_there ? weighted.r : R(0), is_there ? weighted.g : R(0), is_there ? weighted.b : R(0));
        const real merged_ratio = is_there ? ratio * change : ratio;
#if APART
        const int is_apart = (ratio >= R(0)) & (AT_UINT(shifted, state, at) < shift_reconnected);
        const rgb value =
            rgb3(is_apart ? so_far.r : merged.r, is_apart ? so_far.g : merged.g, is_apart ? so_far.b : merged.b);
        SET_RGB(shifted, value, at, value);
        AT(shifted, ratio, at) = is_apart ? ratio : merged_ratio;
        brightest = r_max(brightest, rgb_max(value));
#else
        const size_t to = (size_t)j * slots + slot;
        SET_RGB(difference, throughput, to, merged);
        AT(difference, ratio, to) = merged_ratio;
        brightest = r_max(brightest, rgb_max(merged));
#endif
    }

    real eta = R(1);
#if TRAIT_REFRACTION
    eta = AT(vertex, eta, row) * s.eta;
    AT(vertex, eta, row) = eta;
#endif
    const real survival = depth + 1u >= roulette_depth ? r_min(brightest * eta * eta, R(0.95)) : R(1);
    const int alive = depth + 1u < max_depth && s.pdf > R(0) && brightest > R(0) && u.d < survival;
#if APART
    /* Divided by the chance of surviving, both: it is a factor of either path, and of no density that weighs them. */
    const real inverse_survival = R(1) / (alive ? survival : R(1));
    SET_RGB(vertex, throughput, row, rgb_scale(throughput, inverse_survival));
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        SCALE_RGB(shifted, value, at, inverse_survival);
    }
#else
    /* From here on the row's throughput counts from 1, but for its size, which roulette goes by; the slot has the
     * rest. */
    const real inverse = R(1) / (alive ? brightest : R(1));
    SET_RGB(prefix, throughput, slot, rgb_scale(throughput, inverse));
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t to = (size_t)j * slots + slot;
        SCALE_RGB(difference, throughput, to, inverse);
    }
    SET_RGB(vertex, throughput, row, rgb_gray(alive ? brightest / survival : R(0)));
#endif

    const vec3 direction = v3_normalize(frame_to_world(axes, s.wo));
    const vec3 origin =
        ray_origin(AT_V3(vertex, position, row), AT_V3(vertex, geometric, row), AT(vertex, offset, row), direction);
    AT_UINT(vertex, depth, row) = depth + 1u;
    AT(vertex, pdf, row) = BSDF_IS_DIRAC ? R(0) : s.pdf;
    SET_V3(ray, origin, row, origin);
    SET_V3(ray, direction, row, direction);
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
}
