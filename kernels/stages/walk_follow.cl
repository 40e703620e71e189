/* walk_follow: vertex k of walks whose rays were traced. The surface must be of the kind that it was, and do as it did
 * (`chain_event`); the ray and its derivatives go on from there.
 *
 * LANDS: k is the last vertex, and what follows is the end, in the plane of the walk. The step is taken where the end
 * has come nearer to the target, else halved (Jakob and Marschner 2012, section 5.1). `replays`: it is not a step but
 * the chain as it was asked, on the primitives that it lies on: nothing was traced. */
//! traits: TRAIT_BLENDS
#include "kernels/lib/chain_event.h"
#include "kernels/lib/chain_hit.h"
#include "kernels/lib/chain_spread.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/material.h"
#include "kernels/shared/stage.h"

/* Cosines below this fail: the derivatives would be rounding. */
#define GRAZING R(1e-4)

STAGE
#if LANDS
walk_land
#else
walk_follow
#endif
    (uint count, uint unit, uint first_row, uint k, uint replays, uint chain_rows, uint chain_vertices,
     __global const real *chain_vertex, __global const real *chain_event, __global real *walk_ray,
     __global real *walk_beam, __global real *walked_vertex, __global const real *triangles,
     __global const real *triangle_normals, __global const real *triangle_tangents, __global const real *spheres,
     uint triangle_count, __global const uint *primitive_material, __global const uint *material_back,
     __global const uint *walked_kind, __global const real *materials,
#if LANDS
     uint most_vertices, uint most_steps, real walk_tolerance, real walk_rounding, real walk_back_tolerance,
     __global const real *chain, __global real *walk, __global real *walked, __global uint *walk_bin
#else
     __global const real *walk
#endif
    ) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first_row + i;
    const uint number = AT_UINT(walk, chain, row);
    const size_t at = (size_t)k * chain_rows + number;

    /* The surface. */
    const uint traced = AT_UINT(walk_ray, primitive, row), known = AT_UINT(chain_vertex, primitive, at);
    const uint found = replays ? known : traced;
    const uint failed = AT_UINT(walk_beam, outcome, row);
    const int is_alive = failed == walk_unfinished;
    const int is_hit = is_alive & (found < ray_first_special);
    const uint present = is_hit ? found : 0u;
    const vec3 direction = AT_V3(walk_ray, direction, row), from = AT_V3(walk_beam, from, row);
    const primitive_hit hit =
        chain_hit_of(triangles, spheres, unit, triangle_count, present, AT_V3(walk_ray, origin, row), from, direction);
    surface_point point = surface_point_at(triangles, triangle_normals, triangle_tangents, spheres, unit,
                                           triangle_count, primitive_material, material_back, present, hit, direction);
#if TRAIT_BLENDS
    /* On the same blend the same part. Its chance is the same there: of textured weights no part has a kind. */
    point.material =
        point.material == AT_UINT(chain_event, whole, at) ? AT_UINT(chain_vertex, record, at) : point.material;
#endif
    const vec3 n = point.shading;
    const normal_change change =
        normal_change_of(triangles, triangle_normals, spheres, unit, triangle_count, present, hit, n, point.geometric);
    const uint kind = walked_kind[point.material];
    const real ratio = material_load(materials, point.material, unit).ior;
    AT_UINT(walked_vertex, primitive, at) = present;
    SET_SURFACE_VERTEX(walked_vertex, at, is_hit ? kind : kind_none, point, direction)

    /* What it does. */
    const uint asked = AT_UINT(chain_event, kind, at);
    const real half_x = AT(chain_event, half_x, at), half_y = AT(chain_event, half_y, at);
    const real ior = kind_number(kind) == bsdf_kind_null ? R(1) : ratio;
    const int alike = kind == (asked & event_kind_mask);
    const vertex_event event = vertex_event_of(v3_neg(direction), n, half_x, half_y, (asked & event_reflects) != 0u,
                                               (asked & event_behind) != 0u, ior);
    const real distance = v3_dot(v3_sub(point.position, from), direction);
    const real cosine = v3_dot(point.geometric, direction);
    const int has_glossy_index = ((asked & event_reflects) != 0u) | ((kind & kind_is_dirac) != 0u) |
                                 (r_after(r_abs(ior * ior - R(1)), cosine) > GRADUS_HALF_VECTOR_SAME_INDEX);
    const int follows = is_hit & alike & event.is_valid & has_glossy_index & ((asked & event_unknown) == 0u) &
                        (r_abs(cosine) > GRAZING) & (distance > R(0));
    const uint reason = is_alive ? (is_hit ? (alike ? walk_event : walk_kinds) : walk_nothing) : failed;
    const uint outcome = follows ? walk_unfinished : reason;

    /* How that changes with the first direction. */
    ray_differential beam;
    beam.position_s = AT_V3(walk_beam, position_s, row);
    beam.position_t = AT_V3(walk_beam, position_t, row);
    beam.direction_s = AT_V3(walk_beam, direction_s, row);
    beam.direction_t = AT_V3(walk_beam, direction_t, row);
    beam = ray_differential_at(beam, direction, distance, point.geometric,
                               R(1) / (r_abs(cosine) > GRAZING ? cosine : R(1)));
    const vec3 out_s =
        vertex_event_change(event, n, half_x, half_y, beam.direction_s, normal_change_along(change, beam.position_s));
    /* One after the other: kernels/lib/ordered.h. */
    const vec3 out_t = vertex_event_change(event, v3_after(n, out_s.x), half_x, half_y, beam.direction_t,
                                           normal_change_along(change, v3_after(beam.position_t, out_s.x)));
    const vec3 out = v3_scale(event.wo, R(1) / r_sqrt(r_max(v3_dot(event.wo, event.wo), R(1e-30))));
    const real turn = AT(walk_beam, turn, row) * ((kind & kind_is_dirac) != 0u ? R(1) : event.turn);
    const int is_first = k == 0u;
    const vec3 first = v3_select(is_first, point.position, AT_V3(walk_beam, first, row));
    const vec3 first_s = v3_select(is_first, beam.position_s, AT_V3(walk_beam, first_s, row));
    const vec3 first_t = v3_select(is_first, beam.position_t, AT_V3(walk_beam, first_t, row));
#if !LANDS
    AT_UINT(walk_beam, outcome, row) = outcome;
    AT(walk_beam, turn, row) = turn;
    SET_V3(walk_beam, from, row, point.position);
    SET_V3(walk_beam, position_s, row, beam.position_s);
    SET_V3(walk_beam, position_t, row, beam.position_t);
    SET_V3(walk_beam, direction_s, row, out_s);
    SET_V3(walk_beam, direction_t, row, out_t);
    SET_V3(walk_beam, first, row, first);
    SET_V3(walk_beam, first_s, row, first_s);
    SET_V3(walk_beam, first_t, row, first_t);
    const vec3 origin = ray_origin(point.position, point.geometric, point.offset, out);
    SET_V3(walk_ray, origin, row, origin);
    SET_V3(walk_ray, direction, row, out);
    AT_UINT(walk_ray, primitive, row) = follows ? ray_pending : ray_none;
#else
    /* Where it ends, and the step from there to the target. */
    const vec3 end = AT_V3(chain, end, number), end_normal = AT_V3(chain, end_normal, number);
    const vec3 target = AT_V3(chain, target, number), target_normal = AT_V3(chain, target_normal, number);
    const real of_rays = traced_rounding(end, target), rounding = walk_rounding * of_rays;
    const vec3 plane = walk_plane(end, end_normal, target, target_normal, rounding);
    const real plane_cosine = v3_dot(plane, out);
    const int meets = r_abs(plane_cosine) > GRAZING;
    const real inverse_cosine = R(1) / (meets ? plane_cosine : R(1));
    const real reach = v3_dot(v3_sub(target, point.position), plane) * inverse_cosine;
    const vec3 landed = v3_mad(point.position, reach, out);
    const vec3 end_s = ray_step_at(beam.position_s, out_s, out, reach, plane, inverse_cosine);
    const vec3 end_t = ray_step_at(beam.position_t, out_t, v3_after(out, end_s.x), reach, plane, inverse_cosine);
    const vec3 wanted = v3_sub(target, landed), strayed = v3_sub(end, landed);
    const chain_step step = chain_step_for(wanted, end_s, end_t, plane, first_s, first_t);
    const real miss = v3_dot(wanted, wanted), stray = r_after(v3_dot(strayed, strayed), miss);

    /* Accept or halve. */
    /* The first vertex is known to rounding, which the chain magnifies on the way to the end. */
    const real magnified = (v3_dot(end_s, end_s) + v3_dot(end_t, end_t)) /
                           r_max(v3_dot(first_s, first_s) + v3_dot(first_t, first_t), R(1e-30));
    const real magnification = r_sqrt(r_max(magnified, R(1)));
    const real tolerance = walk_tolerance * reach + rounding * magnification;
    const real base_tolerance = walk_back_tolerance * reach + of_rays * magnification;
    const int lands = follows & meets & (reach > R(0)) & step.is_valid;
    const int is_nearer = miss < AT(walk, miss, row);
    const int is_base = replays ? stray <= base_tolerance * base_tolerance : 1;
    const int is_taken = lands & is_nearer & is_base;
    const int has_arrived = is_taken & (miss <= tolerance * tolerance);
    const uint steps = AT_UINT(walk, steps, row) + (replays ? 0u : 1u);
    const uint why_not = follows ? (lands ? (is_taken ? walk_unfinished : walk_diverged) : walk_nothing) : outcome;
    const uint now = (replays & !is_taken) ? walk_base : why_not;
    const int is_done = has_arrived | (steps >= most_steps) | (replays & !is_taken);
    const real old_share = AT(walk, share, row);
    const real doubled = r_min(R(2) * old_share, R(1));
    const vec3 kept_first = v3_select(is_taken, first, AT_V3(walk, first, row));
    const vec3 kept_step = v3_select(is_taken, step.step, AT_V3(walk, move, row));
    const real kept_miss = is_taken ? miss : AT(walk, miss, row);
    SET_V3(walk, first, row, kept_first);
    SET_V3(walk, move, row, kept_step);
    AT(walk, share, row) = is_taken ? doubled : R(0.5) * old_share;
    AT(walk, miss, row) = kept_miss;
    AT_UINT(walk, steps, row) = steps;
    AT_UINT(walk, outcome, row) = now;
    walk_bin[row] = is_done ? bin_none : most_vertices - 1u - k;

    AT_UINT(walked, outcome, number) = has_arrived ? walk_arrived : now;
    AT_UINT(walked, steps, number) = steps;
    const real old_spread = AT(walked, base_spread, number), old_turn = AT(walked, base_turn, number);
    const real base_spread = chain_spread(end_s, end_t, out, end_normal);
    AT(walked, base_spread, number) = replays ? base_spread : old_spread;
    AT(walked, base_turn, number) = replays ? turn : old_turn;
    AT(walked, spread, number) = chain_spread(end_s, end_t, out, target_normal);
    AT(walked, turn, number) = turn;
#endif
}
