/* walk_events: what each vertex of a chain does, told by its neighbours: which BSDF kind it is, whether it mirrors, and
 * at which half vector where it is glossy. get_global_id(2) is the vertex. */
//! traits: TRAIT_BLENDS
#include "kernels/lib/chain_event.h"
#include "kernels/lib/chain_hit.h"
#include "kernels/lib/chain_start.h"
#include "kernels/shared/material.h"
#include "kernels/shared/stage.h"

STAGE walk_events(uint count, uint unit, uint chain_rows, uint chain_vertices, __global const real *chain,
                  __global const real *chain_vertex, __global real *chain_event, __global const real *triangles,
                  __global const real *triangle_normals, __global const real *triangle_tangents,
                  __global const real *spheres, uint triangle_count, __global const uint *primitive_material,
                  __global const uint *material_back, __global const uint *walked_kind,
                  __global const real *materials) {
    const size_t row = work_item();
    if (row >= count)
        return;
    const uint k = (uint)get_global_id(2), number = AT_UINT(chain, inner, row);
    const size_t at = (size_t)k * chain_rows + row;
    const int is_vertex = k < number, is_last = k + 1u >= number;
    const uint stored = AT_UINT(chain_vertex, primitive, at);
    const uint primitive = is_vertex ? stored : 0u;
    const vec3 here = AT_V3(chain_vertex, position, at);
    vec3 start = AT_V3(chain, start, row);
#if LIGHTS_AT_INFINITY
    const vec3 onward = v3_sub(AT_V3(chain, target, row), here);
    const vec3 along = v3_mad(here, -r_sqrt(v3_dot(onward, onward)), AT_V3(chain, start_normal, row));
    start = v3_select(chain_start_is_far(AT(chain, start_offset, row)), along, start);
#endif
    const vec3 before = v3_select(k == 0u, start, AT_V3(chain_vertex, position, k == 0u ? at : at - chain_rows));
    const vec3 next =
        v3_select(is_last, AT_V3(chain, end, row), AT_V3(chain_vertex, position, is_last ? at : at + chain_rows));
    const vec3 way_in = v3_sub(here, before), way_out = v3_sub(next, here);
    const real in_squared = v3_dot(way_in, way_in), out_squared = r_after(v3_dot(way_out, way_out), in_squared);
    const vec3 direction = v3_scale(way_in, R(1) / r_sqrt(r_max(in_squared, R(1e-30))));
    const vec3 wo = v3_scale(way_out, R(1) / r_sqrt(r_max(out_squared, R(1e-30))));
    const vec3 wi = v3_neg(direction);
    /* From half the way, a sphere is met here and not where it is left. */
    const primitive_hit hit = chain_hit_of(triangles, spheres, unit, triangle_count, primitive,
                                           v3_mad(before, R(0.5), way_in), before, direction);
    const surface_point point =
        surface_point_at(triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count,
                         primitive_material, material_back, primitive, hit, direction);
#if TRAIT_BLENDS
    const uint stored_record = AT_UINT(chain_vertex, record, at);
    const uint record = is_vertex ? stored_record : 0u;
    AT_UINT(chain_event, whole, at) = point.material;
#else
    const uint record = point.material;
#endif
    const material m = material_load(materials, record, unit);
    const uint kind = walked_kind[record];
    const real in_cosine = v3_dot(wi, point.shading), out_cosine = r_after(v3_dot(wo, point.shading), in_cosine);
    const int reflects = in_cosine * out_cosine > R(0);
    const half_vector half_of = half_vector_of(wi, wo, point.shading, reflects, m.ior);
    const int is_dirac = (kind & kind_is_dirac) != 0u;
    AT(chain_event, half_x, at) = is_dirac ? R(0) : half_of.x;
    AT(chain_event, half_y, at) = is_dirac ? R(0) : half_of.y;
    AT_UINT(chain_event, kind, at) = kind | (reflects ? event_reflects : 0u) | (in_cosine < R(0) ? event_behind : 0u) |
                                     (((is_dirac | half_of.is_valid) & (kind != kind_none)) ? 0u : event_unknown);
}
