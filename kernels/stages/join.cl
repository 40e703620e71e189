/* join: what offset paths gain and become that stand at the base path's vertex, one of kind BSDF (rows `first` on),
 * since they have just connected or did so before. Runs after `shade`, before the light is known to be seen:
 * `evaluation` keeps what they would gain, for `gradient_connect` or `weigh`.
 *
 * They take the base path's direction, and all that follows is the same for both. Where that is so of all, what came
 * before is kept by slot, and the base path goes on with a throughput of its own: later stages are the path tracer's
 * and know nothing of offset paths. TRAIT_APART, `keeps`: some are at vertices of their own, so all stay in `offset`.
 *
 * BSDF_IS_MIXED: where the base path takes a Dirac lobe, those that came by its own last direction do so too; those
 * that have just reconnected come by another, in which that lobe leads elsewhere, and fail. With `keeps` they do so in
 * `weigh`, after the light that they see here is weighed.
 *
 * Russian roulette goes by the brightest of them all. */
//! traits: TRAIT_REFRACTION TRAIT_APART TRAIT_TEXTURED_NORMALS SAMPLES_LIGHTS TRAIT_AOV
#include "kernels/lib/bsdf.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/path_draw.h"
#include "kernels/lib/seen_features.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE join(uint count, uint unit, uint first, uint capacity, uint slots, uint roulette_depth,
           __global const real *vertex, __global real *event, __global real *path, __global real *ray,
           __global real *shadow, __global real *offset, __global real *shift, __global real *evaluation,
           __global real *prefix, __global real *difference, __global const real *materials
#if TRAIT_APART
           ,
           uint keeps
#endif
#if TRAIT_AOV == 2 && BSDF_IS_DIRAC
           ,
           __global real *feature
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const int slot = AT_ROW(path, slot, row);
    const uint depth = AT_UINT(path, depth, row);
#if !BSDF_IS_DIRAC
    const material m = VERTEX_MATERIAL(vertex, row);
    const vec3 world_wo = AT_V3(ray, direction, row);
#if !TRAIT_TEXTURED_NORMALS
    const frame axes = VERTEX_FRAME(vertex, row, m);
    const vec3 wo = frame_to_local(axes, world_wo);
#endif
    const real pdf = AT(event, pdf, row);
    const real inverse_pdf = pdf > R(0) ? R(1) / pdf : R(0);
#if SAMPLES_LIGHTS
    const vec3 world_to_light = AT_V3(event, to_light, row);
#if !TRAIT_TEXTURED_NORMALS
    const vec3 to_light = frame_to_local(axes, world_to_light);
#endif
    const rgb arriving = AT_RGB(event, arriving, row);
    const real inverse_light_pdf = AT(event, inverse_light_pdf, row);
    real gained = R(0); /* by offset paths that see what the base path's vertex sees */
#endif
#if BSDF_IS_MIXED
    const int takes_dirac = AT(path, pdf, row) == R(0);
    const rgb dirac_weight = AT_RGB(event, weight, row);
#endif
#else
    const rgb weight = AT_RGB(event, weight, row);
#endif
    const rgb throughput = AT_RGB(path, throughput, row);
    real brightest = rgb_max(throughput);
    int has_offset = 0;
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const real ratio = AT(offset, ratio, at);
        const rgb so_far = AT_RGB(offset, value, at);
        /* Selected, not scaled: where there is no offset path, its direction is anything. */
        const int is_there = ratio >= R(0);
        has_offset |= is_there;
        int is_own = 0;
#if TRAIT_APART
        is_own = is_there & (AT_UINT(offset, state, at) < connection_recent);
#endif
#if BSDF_IS_DIRAC
        /* Only those that are fully connected come to a Dirac vertex. */
        const real change = R(1);
#else
        const vec3 towards = AT_V3(offset, wi, at);
#if TRAIT_TEXTURED_NORMALS
        /* Which normal is seen is a matter of where from. */
        const bsdf_frame place = BSDF_FRAME(vertex, row, m, towards);
        const frame axes = place.axes;
        const vec3 wo = frame_to_local(axes, world_wo);
#if SAMPLES_LIGHTS
        const vec3 to_light = frame_to_local(axes, world_to_light);
#endif
#endif
        const vec3 wi = frame_to_local(axes, towards);
#if SAMPLES_LIGHTS
        const bsdf_value f_light =
            MAPPED_VALUE(place, PASTE(BSDF, _evaluate)(m, wi, to_light, transport_radiance), to_light);
        const rgb gain = rgb_select(is_there, rgb_mul(rgb_mul(so_far, arriving), f_light.value), rgb_gray(R(0)));
        const real gain_bsdf = is_there ? ratio * f_light.pdf * inverse_light_pdf : R(0);
        SET_RGB(evaluation, value, at, gain);
        AT(evaluation, pdf, at) = gain_bsdf;
        AT(shift, light_density, at) = ratio;
        gained = r_max(gained, is_own ? R(0) : rgb_max(gain));
#endif
#if SAMPLES_LIGHTS
        /* The like computation, one after the other (kernels/lib/ordered.h). */
        const vec3 wo_after = v3_after(wo, f_light.value.b + f_light.pdf);
#else
        const vec3 wo_after = wo;
#endif
        const bsdf_value f = MAPPED_VALUE(place, PASTE(BSDF, _evaluate)(m, wi, wo_after, transport_radiance), wo_after);
        const rgb rough_weight = rgb_scale(f.value, inverse_pdf);
        const real rough_change = f.pdf * inverse_pdf;
#if BSDF_IS_MIXED
        const int parts = takes_dirac & (AT_UINT(offset, state, at) == connection_recent);
        const rgb weight = rgb_select(takes_dirac, dirac_weight, rough_weight);
        const real change = takes_dirac ? R(1) : rough_change;
#else
        const rgb weight = rough_weight;
        const real change = rough_change;
#endif
#endif
        int goes_along = is_there;
        real last_ratio = ratio;
#if BSDF_IS_MIXED
        goes_along &= !parts;
        last_ratio = (is_there & parts & !keeps) ? shift_failed(outcome_failed_kinds) : ratio;
#endif
        const rgb merged = rgb_select(goes_along, rgb_mul(so_far, weight), rgb_gray(R(0)));
        const real merged_ratio = goes_along ? ratio * change : last_ratio;
        const rgb value = rgb_select(is_own, so_far, merged);
        brightest = r_max(brightest, rgb_max(value));
#if TRAIT_APART
        if (keeps) {
            SET_RGB(offset, value, at, value);
            AT(offset, ratio, at) = is_own ? ratio : merged_ratio;
        }
#endif
        const int to = (int)(j * slots) + slot;
#if TRAIT_APART
        if (!keeps)
#endif
        {
            SET_RGB(difference, throughput, to, merged);
            AT(difference, ratio, to) = merged_ratio;
        }
    }
#if SAMPLES_LIGHTS && !BSDF_IS_DIRAC
    if (gained > R(0))
        AT_UINT(shadow, open, row) = 1u;
#endif

    const random4 u =
        PATH_DRAW(AT_UINT(path, key_0, row), AT_UINT(path, key_1, row), random_dimension_scatter(depth - 1u));
    real eta = R(1);
#if TRAIT_REFRACTION
    eta = AT(path, eta, row);
#endif
    const real survival = depth >= roulette_depth ? r_min(brightest * eta * eta, R(0.95)) : R(1);
    /* Of what is darker the inverse is beyond all numbers. */
    const int could_go_on = AT_UINT(ray, primitive, row) == ray_pending && brightest >= R(1e-37);
    const int alive = could_go_on && u.d < survival;
    AT_UINT(ray, primitive, row) = alive ? ray_pending : ray_none;
    /* Divided by the chance of surviving, all of them: it is a factor of each path, and of no density that weighs
     * them. Of those at vertices of their own `weigh` does it, after the light that they see there. */
    const real inverse_survival = R(1) / (alive ? survival : R(1));
#if TRAIT_AOV == 2 && BSDF_IS_DIRAC
    SCALE_SEEN_WEIGHT(slot, seen_by_roulette(could_go_on, alive, survival))
#endif
    /* Where all are connected, the row's throughput counts from 1 from here on, but for its size, which roulette goes
     * by; the slot has the rest. Without offset paths the row keeps its own, for the colour of what it may have been
     * seen through (kernels/lib/seen_features.h). */
    const rgb own = rgb_scale(throughput, inverse_survival);
    const real inverse = R(1) / (alive ? brightest : R(1));
    const rgb before = rgb_select(has_offset, rgb_scale(throughput, inverse), rgb_gray(R(1)));
    rgb left = rgb_select(has_offset, rgb_gray(alive ? brightest / survival : R(0)), own);
#if TRAIT_APART
    left = rgb_select(keeps != 0u, own, left);
    if (keeps) {
        AT(event, inverse_survival, row) = inverse_survival;
#pragma unroll
        for (uint j = 0; j < 4; ++j) {
            const size_t at = (size_t)j * capacity + row;
            const int is_own = AT_UINT(offset, state, at) < connection_recent;
            SCALE_RGB(offset, value, at, is_own ? R(1) : inverse_survival);
        }
    }
    if (!keeps)
#endif
    {
        SET_RGB(prefix, throughput, slot, before);
#pragma unroll
        for (uint j = 0; j < 4; ++j) {
            const int to = (int)(j * slots) + slot;
            SCALE_RGB(difference, throughput, to, inverse);
        }
    }
    SET_RGB(path, throughput, row, left);
}
