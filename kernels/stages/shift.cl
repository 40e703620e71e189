/* shift: how offset paths that are not connected go on from their vertices (rows `first` on): with their base path's
 * light sample, and with its direction (Kettunen et al. 2015). Leaves both in `shift`, asks the BSDF service for their
 * values (`evaluation`), and the tracer whether the ways are free (`link`) and what their own rays meet (`offset_ray`).
 * `weigh` goes on once all have answered.
 *
 * The light sample goes to the same light point. The direction: where base and offset vertex are rough and the base's
 * next vertex is reconnectable, the offset path reconnects to it (shift_reconnection.h), or where the base path left
 * the scene, goes in the same direction; else it copies the half vector (shift_half_vector.h, shift_specular.h) and
 * sends out a ray of its own. Which of both is a matter of the two vertices and the base's next one, so that the shift
 * back does the same; `weigh` makes sure of the fourth.
 *
 * TRAIT_MIXED_LOBES: of a kind with a Dirac lobe beside rough ones, the lobe that the base path sampled is part of the
 * path. Where it is the Dirac one, the offset path takes its own Dirac lobe, whatever kind that is of; rough ones
 * likewise.
 *
 * Nothing connects with a surface in whose plane a vertex lies, to within the offsets of rays: on which side of it that
 * is, and so whether light sampled or a direction sampled leads there, were a matter of rounding, and for both samplers
 * of different rounding.
 *
 * The step fails where the next vertex would be seen from its other side, between a Dirac lobe and a rough one, and
 * where the half-vector copy does. Where the vertex is two-sided and seen from its other side by the shading normal
 * alone, which turns its frame (SIDE_BY_SHADING), each of both paths has it in a frame of its own, in which the other
 * one counts for nothing: then they end there together (shift_ends), by light that it may emit.
 *
 * BSDF: where all that is not connected is at vertices of one kind, it is inlined, and what would be asked is answered
 * at once. */
//! traits: TRAIT_SHIFT_DISTANCE TRAIT_ENVIRONMENT TRAIT_MIXED_LOBES TRAIT_LIGHT_TREE SAMPLES_LIGHTS
#include "kernels/lib/bsdf_evaluate.h"
#include "kernels/lib/bsdf_frame.h"
#include "kernels/lib/gradient.h"
#include "kernels/lib/light_sampling.h"
#include "kernels/lib/ordered.h"
#include "kernels/lib/path_draw.h"
#include "kernels/lib/reconnectable.h"
#include "kernels/lib/shift_reconnection.h"
#include "kernels/lib/shift_specular.h"
#include "kernels/lib/surface_side.h"
#include "kernels/lib/textured_material.h"

/* Which lobe of the offset path's vertex a step takes. */
#if TRAIT_APART
#define ASKS_DIRAC base_is_dirac
#else
#define ASKS_DIRAC 0
#endif

/* Whether light may be sampled at the vertices. */
#if defined(BSDF) && BSDF_IS_DIRAC
#define MEETS_LIGHTS 0
#else
#define MEETS_LIGHTS SAMPLES_LIGHTS
#endif

/* Where offset path j receives light from a tree. */
#define RECEIVES(j, member, before)                                                                                    \
    {                                                                                                                  \
        const own_vertex_state own = OWN_STATE(j, row, slot, pixel);                                                   \
        const uint bits =                                                                                              \
            light_normal_bits(v3_after(AT_V3(own_vertex, geometric, own.row), receivers.before.normal.z));             \
        receivers.member = LIGHT_RECEIVER(AT_V3(own_vertex, position, own.row), bits, receivers.before.normal.z);      \
        AT_UINT(shift, receiver, (size_t)(j)*capacity + row) = bits;                                                   \
    }

STAGE shift(uint count, uint unit, uint first, uint stride, uint capacity, uint slots, __global const real *path,
            __global const real *ray, __global const real *vertex, __global const real *event, OWN_VERTEX, STRIP_PLACE,
            __global real *offset, __global real *shift, __global real *evaluation, __global real *link,
            __global const real *materials, __global const real *triangles, __global const real *spheres,
            uint triangle_count, __global const uint *primitive_material, __global const uint *primitive_light,
            __global const uint *material_back, __global const uint *material_kind, real scene_diameter SURFACE_ARGUMENT
#if SAMPLES_LIGHTS
            ,
            __global const real *lights, __global const uint *light_kinds, __global const uint *light_alias,
            uint light_count ENVIRONMENT_PARAMETERS LIGHT_TEXTURE_PARAMETERS LIGHT_PROBABILITY_PARAMETERS
#if LIGHTS_HAVE_PICTURES
            ,
            __global real *shown
#endif
#endif
#if TRAIT_APART
            ,
            __global real *offset_ray
#endif
#if SIDE_BY_SHADING || (TRAIT_APART && TRAIT_TWO_FACED)
            ,
            __global const real *triangle_normals
#endif
#if TRAIT_SHIFT_DISTANCE
            ,
            real shift_distance
#endif
) {
    const size_t i = work_item();
#if MEETS_LIGHTS
    const uint kept = BITS_OF_LIGHTS BITS_OF_LIGHT_TEXTURES;
#else
    const uint kept = 0u;
#endif
    if (!HAS_ROW(i, count, kept))
        return;
    const size_t row = (size_t)first + i;
    const int slot = AT_ROW(path, slot, row);
    const film_pixel pixel = PIXEL_OF(slot);
    const vec3 base = AT_V3(vertex, position, row);
    const real base_offset = AT(vertex, offset, row);
    const uint base_kind = AT_UINT(vertex, kind, row);

    /* Where the base path goes. */
    const uint primitive = AT_UINT(ray, primitive, row);
    const vec3 base_direction = AT_V3(ray, direction, row);
    const int is_hit = primitive < ray_first_special;
    const int is_escaped = TRAIT_ENVIRONMENT && primitive == ray_escaped;
    const uint present = is_hit ? primitive : 0u;
    const primitive_hit hit =
        primitive_hit_of(triangles, spheres, unit, triangle_count, present INSTANCE_IN(ray, ray, row),
                         AT_V3(ray, origin, row), base_direction);
    const real base_side = v3_dot(hit.normal, v3_sub(base, hit.position));
    const real end_offset =
        offset_at(hit.position, hit.normal,
                  primitive_offset(triangles, spheres, unit, triangle_count, present HIT_ARGUMENT(hit)));
    const vec3 end_normal = v3_scale(hit.normal, r_copysign1(base_side));
#if SIDE_BY_SHADING
    const vec3 end_shading = shading_normal_at(triangle_normals, unit, triangle_count, present, hit);
    const int end_turns = (OF_PRIMITIVE(primitive_material, material, present) & material_two_sided) != 0u;
    const int base_from_behind = v3_dot(end_shading, base_direction) > R(0);
#endif
    const real pdf = AT(event, pdf, row);
    const int goes_on = (is_hit | is_escaped) & (pdf > R(0));
#if TRAIT_APART
    int base_is_dirac = (base_kind & kind_is_dirac) != 0u; /* the lobe that it has sampled */
#if TRAIT_MIXED_LOBES
    base_is_dirac |= ((base_kind & kind_is_mixed) != 0u) & (AT(path, pdf, row) == R(0));
#endif
    const int base_is_rough = ((base_kind & kind_is_rough) != 0u) & !base_is_dirac;
    const material base_material = VERTEX_MATERIAL(vertex, row);
    const vec3 base_towards = AT_V3(vertex, wi, row);
    const frame base_axes = BSDF_FRAME(vertex, row, base_material, base_towards).axes;
    const vec3 base_wi = frame_to_local(base_axes, base_towards);
    const vec3 base_wo = frame_to_local(base_axes, base_direction);
    const uint next_light = LIGHT_OF_PRIMITIVE(primitive_light, present);
    int is_behind = 0;
#if TRAIT_TWO_FACED
    is_behind = is_met_from_behind(triangle_normals, unit, triangle_count, present, hit, base_direction);
#endif
#if TRAIT_BLENDS
    const uint next_kind = material_kind[is_hit ? surface_record_at(surface, capacity, row) : 0u];
#else
    const uint next_kind = kind_of_primitive(primitive_material, material_back, material_kind, present, is_behind);
#endif
    const int reconnectable = is_escaped | is_reconnectable(next_kind, next_light);
#endif

#if MEETS_LIGHTS
    /* The base path's light sample, made again. */
    const random4 u = PATH_DRAW(AT_UINT(path, key_0, row), AT_UINT(path, key_1, row),
                                random_dimension_light(AT_UINT(path, depth, row) - 1u));
#if TRAIT_LIGHT_TREE
    /* The same light; each vertex would choose it with a probability of its own. */
    light_receivers receivers;
    receivers.base.normal.z = R(0);
    RECEIVES(0u, offset_0, base)
    RECEIVES(1u, offset_1, offset_0)
    RECEIVES(2u, offset_2, offset_1)
    RECEIVES(3u, offset_3, offset_2)
    light_picked picked;
    picked.light = AT_UINT(event, light, row);
    picked.path = AT(event, light_path, row);
    receivers.base = receivers.offset_0; /* not asked for */
    const light_paths ways = light_tree_paths(light_nodes, TRAIT_LIGHT_TREE, unit, light_leaf[(int)picked.light],
                                              receivers, 0, picked.path, 1);
#endif
    const chosen_light chosen =
        light_sampling(lights, light_kinds, light_alias, light_count, scene_diameter, unit, base,
                       u ENVIRONMENT_ARGUMENTS LIGHT_TEXTURE_ARGUMENTS LIGHT_PICKED_ARGUMENT);
    const light_choice s = chosen.choice;
    const int is_surface =
        IS_LIGHT(chosen, triangle, TRAIT_LIGHT_TRIANGLE) | IS_LIGHT(chosen, sphere, TRAIT_LIGHT_SPHERE);
    const int is_spot = IS_LIGHT(chosen, spot, TRAIT_LIGHT_SPOT);
#if LIGHTS_HAVE_PICTURES
    const int is_projector = IS_LIGHT(chosen, projector, LIGHTS_HAVE_PROJECTORS);
    const int is_point = IS_LIGHT(chosen, point, TRAIT_LIGHT_POINT) | is_spot | is_projector;
#else
    const int is_point = IS_LIGHT(chosen, point, TRAIT_LIGHT_POINT) | is_spot;
#endif
    const int is_finite_light = is_surface | is_point;
    const real base_distance_squared = v3_dot(s.connection, s.connection);
    const real base_cosine = -v3_dot(s.normal, s.direction);
    const real base_above = -v3_dot(s.normal, s.connection); /* the light's plane */
    /* After the light's normal, which is normalised as the ways to it will be (kernels/lib/ordered.h). */
    const vec3 light_point = v3_after(v3_add(base, s.connection), base_cosine);
    const real light_gap = offset_at(light_point, s.normal, LIGHT_FIELD(chosen.light, offset));
    const int arrives = rgb_max(AT_RGB(event, arriving, row)) > R(0);
#if TRAIT_LIGHT_SPOT
    const vec3 spot_axis = LIGHT_V3(chosen.light, e1);
    const real spot_cutoff = LIGHT_FIELD(chosen.light, e2_x), spot_steepness = LIGHT_FIELD(chosen.light, e2_y);
    const real base_falloff = light_spot_falloff(spot_axis, v3_neg(s.direction), spot_cutoff, spot_steepness);
#endif
#if LIGHTS_HAVE_PICTURES
    const vec3 picture_axis = LIGHT_V3(chosen.light, e1);
    const vec3 along_u = PICTURE_V3(chosen.light, along_u), along_v = PICTURE_V3(chosen.light, along_v);
    const uint picture = LIGHT_TEXTURE_FIELD(chosen.light, texture);
    const real base_ahead = -v3_dot(picture_axis, s.direction);
    const real base_profile =
        light_projector_profile(point_of_picture(along_u, along_v, v3_neg(s.direction), base_ahead), base_ahead);
    const rgb arriving_untextured = rgb_scale(chosen.untextured, R(1) / chosen.probability);
#endif
#endif
#pragma unroll
    for (uint j = 0; j < 4; ++j) {
        const size_t at = (size_t)j * capacity + row;
        const own_vertex_state own = OWN_STATE(j, row, slot, pixel);
        const uint kind = AT_UINT(own_vertex, kind, own.row);
        const vec3 from = AT_V3(own_vertex, position, own.row);
        const vec3 geometric = AT_V3(own_vertex, geometric, own.row);
        const real from_offset = AT(own_vertex, offset, own.row);
#ifdef BSDF
        const int is_dirac = BSDF_IS_DIRAC;
#else
        const int is_dirac = (kind & kind_is_dirac) != 0u;
#endif
#if TRAIT_APART || defined(BSDF)
        const material m = VERTEX_MATERIAL(own_vertex, own.row);
        const vec3 towards = AT_V3(own_vertex, wi, own.row);
        const bsdf_frame place = BSDF_FRAME(own_vertex, own.row, m, towards);
        const frame axes = place.axes;
        const vec3 wi = frame_to_local(axes, towards);
#endif

        /* The light sample. */
        int asks_light = 0;
#if MEETS_LIGHTS
        const vec3 to_point = v3_sub(light_point, from);
        const real point_distance_squared = r_max(v3_dot(to_point, to_point), R(1e-36));
        const vec3 to_point_unit = v3_scale(to_point, R(1) / r_sqrt(point_distance_squared));
        const vec3 to_light = v3_select(is_finite_light, to_point_unit, s.direction);
        const real cosine = -v3_dot(s.normal, to_light);
        const real nearer = base_distance_squared / point_distance_squared;
        /* The Jacobian by solid angle; for a point light, which has none, the ratio of what arrives. */
        real light_jacobian = is_point ? nearer : R(1);
#if TRAIT_LIGHT_SPOT
        /* A vertex beyond the cutoff has no light sample of a spot, as one behind a lamp has none of that. */
        const real spot_change =
            base_falloff > R(0)
                ? light_spot_falloff(spot_axis, v3_neg(to_point_unit), spot_cutoff, spot_steepness) / base_falloff
                : R(0);
        light_jacobian *= is_spot ? spot_change : R(1);
#endif
#if LIGHTS_HAVE_PICTURES
        /* Each vertex has its own place of the picture; where it shows nothing there is no light sample either. */
        const vec3 to_own = v3_neg(to_point_unit);
        const real own_ahead = v3_dot(picture_axis, to_own);
        const texture_point own_place = point_of_picture(along_u, along_v, to_own, own_ahead);
        const rgb of_picture = light_texture_at(textures, texture_reals, texels, unit, picture, own_place);
        const real profile_change =
            base_profile > R(0) ? light_projector_profile(own_place, own_ahead) / base_profile : R(0);
        light_jacobian *= is_projector ? profile_change : R(1);
        const int has_picture = is_spot | is_projector;
        const rgb base_arriving = AT_RGB(event, arriving, row);
        const rgb shown_here = rgb_select(has_picture, rgb_mul(arriving_untextured, of_picture), base_arriving);
        light_jacobian = has_picture && rgb_max(shown_here) == R(0) ? R(0) : light_jacobian;
        SET_RGB(shown, arriving, at, shown_here);
#endif
        const real above = -v3_dot(s.normal, to_point);
        const int connects = (above > light_gap + from_offset) & (base_above > light_gap + base_offset);
        light_jacobian = is_surface ? (connects ? nearer * cosine / base_cosine : R(0)) : light_jacobian;
        /* The same point of the same light, chosen with the same density by area. Spheres are sampled by cones. */
        real light_density = light_jacobian > R(0) ? R(1) : R(0);
#if TRAIT_LIGHT_SPHERE
        const vec3 to_center = v3_sub(LIGHT_V3(chosen.light, p), from);
        const real sphere_pdf = light_sphere_pdf(LIGHT_FIELD(chosen.light, e1_x), LIGHT_FIELD(chosen.light, e1_y),
                                                 LIGHT_FIELD(chosen.light, inverse_area), v3_dot(to_center, to_center),
                                                 point_distance_squared, cosine);
        const real by_cone = s.pdf > R(0) ? light_jacobian * sphere_pdf / s.pdf : R(0);
        light_density = IS_LIGHT(chosen, sphere, 1) ? by_cone : light_density;
#endif
#if TRAIT_LIGHT_TREE
        light_density *= LIGHT_PATH_OF(ways, j);
#endif
        AT(shift, light_jacobian, at) = light_jacobian;
        asks_light = own.is_own & !is_dirac & arrives & (light_jacobian > R(0));
#ifdef BSDF
        const vec3 wo_light = frame_to_local(axes, to_light);
        const bsdf_value of_light = MAPPED_VALUE(place, bsdf_evaluate(m, wi, wo_light, 0), wo_light);
        /* Who scatters none of it may still find it, by BSDF sampling. */
        asks_light &= (rgb_max(of_light.value) > R(0)) | (of_light.pdf > R(0));
        const rgb request = of_light.value;
#else
        const rgb request = rgb3(to_light.x, to_light.y, to_light.z);
#endif
        /* Offset paths that are connected keep what `join` left there. */
        const int keeps = TRAIT_APART && !own.is_own;
        const rgb left = rgb_select(keeps, AT_RGB(evaluation, value, at), request);
        SET_RGB(evaluation, value, at, left);
        AT(shift, light_density, at) = keeps ? AT(shift, light_density, at) : light_density;
#ifdef BSDF
        AT(evaluation, pdf, at) = keeps ? AT(evaluation, pdf, at) : of_light.pdf;
#endif
        const vec3 light_origin = ray_origin(from, geometric, from_offset, to_light);
        const vec3 light_end = v3_select(is_finite_light, light_point, v3_add(from, s.connection));
        const size_t light_link = (size_t)j * stride + row;
        SET_V3(link, origin, light_link, light_origin);
        const vec3 light_way = v3_sub(light_end, light_origin);
        SET_V3(link, direction, light_link, connection_before(light_way, s.normal, light_gap, light_way));
#endif
        AT_UINT(link, open, (size_t)j * stride + row) = asks_light ? 1u : 0u;

        /* The step to the next vertex: the like computation, one after the other (kernels/lib/ordered.h). */
#if MEETS_LIGHTS
        const vec3 from_after = v3_after(from, cosine);
#else
        const vec3 from_after = from;
#endif
        const vec3 connection = v3_sub(hit.position, from_after);
        const vec3 to_next = v3_select(is_escaped, base_direction, v3_normalize(connection));
        const real reconnection = is_escaped ? R(1) : reconnection_jacobian(base, from_after, hit.position, hit.normal);
        const real side = -v3_dot(hit.normal, connection);
        const int same_side = is_escaped | ((side * base_side > R(0)) & (r_abs(side) > end_offset + from_offset) &
                                            (r_abs(base_side) > end_offset + base_offset));
        uint ends = 0u;
#if SIDE_BY_SHADING
        const int from_behind = v3_dot(end_shading, v3_after(to_next, reconnection)) > R(0);
        ends = (is_hit & end_turns & (from_behind != base_from_behind)) ? shift_ends : 0u;
#endif
#if TRAIT_APART
        const int both_rough = base_is_rough & ((kind & kind_is_rough) != 0u);
#if TRAIT_SHIFT_DISTANCE
        const int is_long = is_escaped | is_far(base, from, hit.position, next_light, shift_distance);
#else
        const int is_long = 1;
#endif
        const int reconnects = both_rough & reconnectable & is_long;
#if defined(BSDF) && !BSDF_IS_MIXED
        const int alike = kind != kind_none;
#if BSDF_IS_DIRAC
        const real ior = kind_number(kind) == bsdf_kind_null ? R(1) : m.ior;
        const shifted_direction copied = shift_specular(base_wi, base_wo, wi, ior);
#else
        const shifted_direction copied = shift_half_vector(base_wi, base_wo, base_material.ior, wi, m.ior);
#endif
        const vec3 wo_copied = copied.wo;
        const int copies = alike & copied.is_valid;
        const real copy_jacobian = copied.jacobian;
#else
        int has_lobe = is_dirac == base_is_dirac;
#if TRAIT_MIXED_LOBES
        has_lobe |= (kind & kind_is_mixed) != 0u;
#endif
        const int alike = (kind != kind_none) & has_lobe;
        const real ior = kind_number(kind) == bsdf_kind_null ? R(1) : m.ior;
        const shifted_direction mirrored = shift_specular(base_wi, base_wo, wi, ior);
        const shifted_direction copied = shift_half_vector(base_wi, base_wo, base_material.ior, wi, ior);
        const vec3 wo_copied = v3_select(base_is_dirac, mirrored.wo, copied.wo);
        const int copies = alike & (base_is_dirac ? mirrored.is_valid : copied.is_valid);
        const real copy_jacobian = base_is_dirac ? mirrored.jacobian : copied.jacobian;
#endif
        const vec3 own_direction = frame_to_world(axes, wo_copied);
        const vec3 own_unit =
            v3_scale(own_direction, R(1) / r_max(r_sqrt(v3_dot(own_direction, own_direction)), R(1e-15)));
        const vec3 direction = v3_select(reconnects, to_next, own_unit);
        const real step_jacobian = reconnects ? reconnection : copy_jacobian;
        int works = goes_on & (reconnects ? same_side & (reconnection > R(0)) : copies);
        const uint reason = reconnects ? outcome_failed_side : alike ? outcome_failed_copy : outcome_failed_kinds;
        const uint way =
            (reconnects ? outcome_reconnected | ends : outcome_half_vector) | (both_rough ? shift_both_rough : 0u);
#else
        const int reconnects = 1;
        const vec3 direction = to_next;
        const real step_jacobian = reconnection;
        int works = goes_on & same_side & (reconnection > R(0));
        const uint reason = kind == kind_none ? outcome_failed_at_once : outcome_failed_side;
        const uint way = outcome_reconnected | ends;
#endif
        const size_t step = (size_t)(4u + j) * capacity + row;
#ifdef BSDF
        const vec3 wo_step = frame_to_local(axes, direction);
        const bsdf_value of_step = MAPPED_VALUE(place, bsdf_evaluate(m, wi, wo_step, ASKS_DIRAC), wo_step);
        const int has_density = of_step.pdf > R(0);
        works &= reconnects | has_density;
        SET_RGB(evaluation, value, step, of_step.value);
        AT(evaluation, pdf, step) = of_step.pdf;
#else
        const int has_density = 1; /* `evaluate` will know */
        AT(evaluation, value_r, step) = direction.x;
        AT(evaluation, value_g, step) = direction.y;
        AT(evaluation, value_b, step) = direction.z;
#endif
        AT(shift, jacobian, at) = works ? step_jacobian : R(0);
        AT_UINT(shift, outcome, at) = works ? way : reason;
        const vec3 last = v3_select(own.is_own, direction, base_direction);
        SET_V3(offset, wi, at, v3_neg(last));

        const vec3 origin = ray_origin(from, geometric, from_offset, direction);
        const size_t step_link = (size_t)(4u + j) * stride + row;
        SET_V3(link, origin, step_link, origin);
        const vec3 to_hit = v3_sub(hit.position, origin);
        const vec3 to_end = connection_before(to_hit, end_normal, end_offset, to_hit);
        const vec3 way_out = v3_select(is_escaped, v3_scale(direction, scene_diameter), to_end);
        SET_V3(link, direction, step_link, way_out);
        AT_UINT(link, open, step_link) = (own.is_own & reconnects & works & has_density) ? 1u : 0u;
#if TRAIT_APART
        const size_t sent = (size_t)j * stride + row;
        SET_V3(offset_ray, origin, sent, origin);
        SET_V3(offset_ray, direction, sent, direction);
        AT_UINT(offset_ray, primitive, sent) = (own.is_own & !reconnects & works) ? ray_pending : ray_none;
#endif
    }
}
