/* weigh: what `shift` asked is answered: adds the light sampled at vertices with offset paths that are not connected
 * (rows `first` on) to the base path and to its differences, weighted by all that find it, and takes those offset paths
 * on.
 *
 * Who does not see the light has contribution zero there, and BSDF sampling does not find it; light sampling still
 * does, so this is no failure of the shift. Where a vertex is not rough the two samplers shift differently: each is
 * then an integrand of its own, weighted by its share within each path.
 *
 * Offset paths that reconnect stand at the base's next vertex, whether they see it or not: the light that it emits must
 * be weighed before the hidden ones fail (`gradient_emission`, `advance`). Those that copied have failed where their
 * ray met nothing, and, if they came from rough vertices like the base path, where both could reconnect: there the
 * shift back would.
 *
 * TRAIT_MIXED_LOBES: offset paths that have just reconnected to a vertex at which the base path then takes a Dirac lobe
 * fail once the light there is weighed: seen from elsewhere, that lobe does not lead there, nor would the way back.
 *
 * Roulette has been played by `join`, but light is sampled before it: of what goes on only the step is divided by its
 * chance.
 *
 * AT_FIRST: whether the rows are those at first vertices. */
//! traits: TRAIT_SHIFT_DISTANCE TRAIT_MIXED_LOBES
#include "kernels/lib/gradient.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/reconnectable.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/textured_material.h"
#include "kernels/lib/weighted_difference.h"

/* Sums begin at first vertices. */
#if !AT_FIRST
#define GATHER(table, at, sum)                                                                                         \
    {                                                                                                                  \
        const rgb before = AT_RGB(table, value, at);                                                                   \
        const rgb after = rgb_add(before, sum);                                                                        \
        SET_RGB(table, value, at, after);                                                                              \
    }
#else
#define GATHER(table, at, sum) SET_RGB(table, value, at, sum);
#endif

/* What the light sends to the offset vertex. */
#if TRAIT_TEXTURED_LIGHTS & textured_lights_pictures
#define OWN_ARRIVING AT_RGB(shown, arriving, at)
#else
#define OWN_ARRIVING arriving
#endif

STAGE weigh(uint count, uint unit, uint first, uint stride, uint capacity, uint slots, __global const real *path,
            __global const real *shadow, __global const real *event, __global const real *vertex, OWN_VERTEX,
            STRIP_PLACE, __global real *offset, __global real *shift, __global const real *evaluation,
            __global const real *link, __global real *prefix, __global real *difference
#if TRAIT_TEXTURED_LIGHTS & textured_lights_pictures
            ,
            __global const real *shown
#endif
#if TRAIT_APART
            ,
            __global const real *ray, __global const real *offset_ray, __global uint *offsets_state,
            __global const real *triangles, __global const real *spheres, uint triangle_count,
            __global const uint *primitive_material, __global const uint *primitive_light,
            __global const uint *material_back, __global const uint *material_kind
#if TRAIT_BLENDS
            ,
            __global const real *surface, __global const real *offset_surface
#endif
#if TRAIT_TWO_FACED
            ,
            __global const real *triangle_normals
#endif
#endif
#if TRAIT_SHIFT_DISTANCE
            ,
            real shift_distance
#endif
) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = (size_t)first + i;
    const int slot = AT_ROW(path, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
    const uint base_kind = AT_UINT(vertex, kind, row);
    const int is_lit = rgb_max(AT_RGB(event, arriving, row)) > R(0);
    const int base_sees = is_lit & (AT_UINT(shadow, open, row) != 0u);
    const real seen = base_sees ? R(1) : R(0);
    const rgb shadow_value = AT_RGB(shadow, value, row);
    /* Selected, not scaled: where no light was sampled nothing was written. */
    const rgb base = rgb_select(base_sees, shadow_value, rgb_gray(R(0)));
    const real base_bsdf = seen * AT(event, base_bsdf, row);
    const rgb alone = rgb_scale(base, R(1) / (R(1) + base_bsdf));
    const rgb arriving = AT_RGB(event, arriving, row);
    const real inverse_light_pdf = AT(event, inverse_light_pdf, row);
    GATHER(prefix, slot, alone)

    const real pdf = AT(event, pdf, row);
    const real inverse_pdf = pdf > R(0) ? R(1) / pdf : R(0);
    real inverse_survival = R(1); /* at first vertices there is no roulette */
#if TRAIT_APART && !AT_FIRST
    inverse_survival = AT(event, inverse_survival, row);
#endif
#if TRAIT_APART
    const uint primitive = AT_UINT(ray, primitive, row);
    const int is_hit = primitive < ray_first_special;
    int base_is_behind = 0;
#if TRAIT_TWO_FACED
    base_is_behind = primitive_is_behind(triangles, triangle_normals, spheres, unit, triangle_count,
                                         is_hit ? primitive : 0u INSTANCE_IN(ray, ray, row), AT_V3(ray, origin, row),
                                         AT_V3(ray, direction, row));
#endif
#if TRAIT_BLENDS
    const uint next_kind = material_kind[is_hit ? surface_record_at(surface, capacity, row) : 0u];
#else
    const uint next_kind =
        kind_of_primitive(primitive_material, material_back, material_kind, is_hit ? primitive : 0u, base_is_behind);
#endif
    int any_apart = 0, all_alike = 1, meets_light = 0;
    int base_is_dirac =
        0; /* the lobe that it has sampled; told apart where offset paths may stand at kinds with both */
#if TRAIT_MIXED_LOBES
    base_is_dirac = ((base_kind & (kind_is_dirac | kind_is_mixed)) != 0u) & (AT(path, pdf, row) == R(0));
#endif
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const size_t step = (size_t)(4u + j) * capacity + row;
        const int to = (int)(j * slots) + slot;
        const own_vertex_state own = OWN_STATE(j, row, slot, pixel);
        const uint kind = AT_UINT(own_vertex, kind, own.row);
        const int is_dirac = (kind & kind_is_dirac) != 0u;
        const int both_rough = (base_kind & kind & kind_is_rough) != 0u;

        /* The light sample. Selected, not scaled: of offset paths that are no longer their own nothing was asked, so
         * what is read here of `evaluation` and `shift` may be of another row's time. */
        const rgb f_light = AT_RGB(evaluation, value, at);
        const real pdf_light = AT(evaluation, pdf, at), density = AT(shift, light_density, at);
        const real jacobian_light = AT(shift, light_jacobian, at);
        const real own_bsdf = pdf_light * jacobian_light * inverse_light_pdf;
        const int scatters = !is_dirac;
        const real share = both_rough ? R(1) : R(1) / (R(1) + (density > R(0) ? own_bsdf / density : R(0)));
        const int own_sees = is_lit & scatters & (AT_UINT(link, open, (size_t)j * stride + row) != 0u);
        const rgb own_value =
            rgb_select(own_sees, rgb_scale(rgb_mul(rgb_mul(own.value, OWN_ARRIVING), f_light), jacobian_light * share),
                       rgb_gray(R(0)));
        const int own_is_split = own.is_own & !both_rough;
        rgb value = own_value;
        real offset_light = is_lit ? density * own.ratio : R(0);
        offset_light = scatters ? offset_light : shift_failed(outcome_failed_kinds);
        real offset_bsdf = own_sees & both_rough ? own_bsdf * own.ratio : R(0);
        int is_split = own_is_split;
#if TRAIT_APART
        /* Those at the base's vertex: `join` has left what they gain if the light is seen from there. */
        const int shares = own.is_there & !own.is_own;
        value = rgb_select(shares, rgb_select(base_sees, f_light, rgb_gray(R(0))), value);
        offset_light = shares ? (is_lit ? density : R(0)) : offset_light;
        offset_bsdf = shares ? (base_sees ? pdf_light : R(0)) : offset_bsdf;
#endif
        const real marker = own.is_there ? offset_light : own.ratio;
        const rgb mine = rgb_select(is_split, alone, base);
        real weight = weight_of_difference(is_split ? R(0) : base_bsdf, offset_light + offset_bsdf, marker);
#if TRAIT_APART
        weight = shares ? weight_of_light_at_shared_vertex(base_bsdf, offset_bsdf, offset_light) : weight;
#endif
        const rgb change = difference_of(mine, value, weight, marker);
        GATHER(difference, to, change)

        /* The step. */
        const rgb f = AT_RGB(evaluation, value, step);
        const real step_pdf = AT(evaluation, pdf, step), jacobian = AT(shift, jacobian, at);
        const uint outcome = AT_UINT(shift, outcome, at);
        const int reconnects = shift_outcome_of(outcome) == outcome_reconnected;
        const int is_possible = jacobian > R(0);
        /* A reconnection that the BSDF would not have sampled has the density zero; a copy cannot have it. */
        const int works = is_possible & (reconnects | (step_pdf > R(0)));
        const uint reason = is_possible ? outcome_failed_copy : shift_outcome_of(outcome);
        const real factor = works ? jacobian * inverse_pdf : R(0);
        const rgb stepped = rgb_mul(own.value, rgb_scale(f, factor * inverse_survival));
        real ratio = works ? own.ratio * step_pdf * factor : shift_failed(reason);
#if TRAIT_APART
        const size_t sent = (size_t)j * stride + row;
        const uint offset_primitive = AT_UINT(offset_ray, primitive, sent);
        const int meets = offset_primitive < ray_first_special;
        const uint met = meets ? offset_primitive : 0u;
        int is_behind = 0;
#if TRAIT_TWO_FACED
        is_behind = primitive_is_behind(triangles, triangle_normals, spheres, unit, triangle_count,
                                        met INSTANCE_IN(offset_ray, offset_ray, sent), AT_V3(offset_ray, origin, sent),
                                        AT_V3(offset_ray, direction, sent));
#endif
#if TRAIT_BLENDS
        const uint met_kind =
            material_kind[meets ? surface_record_at(offset_surface, 4u * (size_t)capacity, sent) : 0u];
#else
        const uint met_kind = kind_of_primitive(primitive_material, material_back, material_kind, met, is_behind);
#endif
        int would_reconnect = is_reconnectable(met_kind, LIGHT_OF_PRIMITIVE(primitive_light, met));
#if TRAIT_SHIFT_DISTANCE
        const vec3 met_position =
            primitive_hit_of(triangles, spheres, unit, triangle_count, met INSTANCE_IN(offset_ray, offset_ray, sent),
                             AT_V3(offset_ray, origin, sent), AT_V3(offset_ray, direction, sent))
                .position;
        would_reconnect &= is_far(AT_V3(vertex, position, row), AT_V3(own_vertex, position, own.row), met_position,
                                  LIGHT_OF_PRIMITIVE(primitive_light, met), shift_distance);
#endif
        const int was_rough = (outcome & shift_both_rough) != 0u;
        const int copies = own.is_own & works & !reconnects;
        const int comes_back = !(was_rough & would_reconnect);
        /* A base path that left the scene has no next vertex: `gradient_emission` sees to its offset paths. */
        const int has_failed = copies & is_hit & !(meets & comes_back);
        ratio = has_failed ? shift_failed(meets ? outcome_failed_back : outcome_failed_nothing) : ratio;
        const int is_apart = copies & is_hit & !has_failed;
        any_apart |= is_apart;
        meets_light |= copies & meets & (LIGHT_OF_PRIMITIVE(primitive_light, met) != no_light);
        all_alike &= !is_apart | (kind_number(met_kind) == kind_number(next_kind));
        const int parts =
            base_is_dirac & own.is_there & !own.is_own & (AT_UINT(offset, state, at) == connection_recent);
        AT_UINT(offset, state, at) = own.is_own ? (reconnects  ? connection_recent
                                                   : was_rough ? connection_none_rough
                                                               : connection_none)
                                                : connection_full;
        AT(offset, pdf, at) = is_dirac | base_is_dirac ? R(0) : step_pdf;
        AT(shift, light_density, at) = own.ratio; /* for `gradient_emission` */
#endif
        const rgb taken = rgb_select(works, stepped, rgb_gray(R(0)));
        const rgb next = rgb_select(own.is_own, taken, own.value);
        SET_RGB(offset, value, at, next);
        real shared_ratio = own.ratio;
#if TRAIT_APART
        shared_ratio = parts ? shift_failed(outcome_failed_kinds) : shared_ratio;
#endif
        AT(offset, ratio, at) = own.is_own ? ratio : shared_ratio;
    }
#if TRAIT_APART
    offsets_state[row] = (any_apart ? (all_alike ? offsets_alike : offsets_mixed) : offsets_connected) |
                         (meets_light ? offsets_meet_light : 0u);
#endif
}
