/* photon_walk: what photon_project asked is answered: asks for the manifold walk that moves the end of the photon's
 * chain to where the offset photon is (Hua et al. 2017, section 4.2), unless that does not count there. Leaves in
 * `moved_ratio` how much larger the surface is there, |dy'/dy|. */
//! traits: TRAIT_BLENDS
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/photon_chain.h"
#include "kernels/lib/surface_point.h"

STAGE photon_walk(uint count, uint unit, uint first, uint pairs, uint capacity, uint gather_rows, uint photon_rows,
                  uint pair_rows, uint strip_pixels, uint chain_bin, uint most_inner, uint chain_rows,
                  uint chain_vertices, __global const uint *moved_index, __global const uint *pair_gather,
                  __global const uint *pair_photon, __global const real *gather, __global const real *photon_sorted,
                  __global const real *light_vertices, __global const uint *light_vertex_marks,
                  __global const uint *leaving_bin, __global real *moved, __global const real *moved_link,
                  __global const real *triangles, __global const real *triangle_normals,
                  __global const real *triangle_tangents, __global const real *spheres, uint triangle_count,
                  __global const uint *primitive_material, __global const uint *material_back, __global real *chain,
                  __global real *chain_vertex) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    const int row = (int)pair_gather[pair], from = (int)pair_photon[pair], at = row + (int)((j + 1u) * strip_pixels);
    const uint primitive = AT_UINT(moved, primitive, to);
    const int is_hit = primitive < ray_first_special;
    const surface_point point = surface_point_of(
        triangles, triangle_normals, triangle_tangents, spheres, unit, triangle_count, primitive_material,
        material_back, is_hit ? primitive : 0u, AT_V3(moved, origin, to), AT_V3(moved, direction, to));
    const photon_disc base = PHOTON_DISC(row), offset = PHOTON_DISC(at);
    const int arrives = is_hit & (AT_UINT(moved_link, open, i) != 0u) &
                        photon_counts(offset, point.position, point.geometric) &
                        !photon_counts(base, point.position, point.geometric);
    const real facing = r_max(v3_dot(point.geometric, offset.normal), GRADUS_PHOTON_LEAST_FACING);
    AT(moved, ratio, to) = AT(moved, ratio, to) / facing;

    const uint last = AT_UINT(photon_sorted, before, from);
    const photon_chain found = photon_chain_of(light_vertex_marks, leaving_bin, chain_bin, most_inner, unit, last);
    const vec3 start = FIELD_V3(light_vertex, light_vertices, found.start, position);
    const vec3 start_normal = FIELD_V3(light_vertex, light_vertices, found.start, geometric);
    const vec3 end = AT_V3(photon_sorted, position, from), end_normal = AT_V3(photon_sorted, normal, from);
    SET_V3(chain, start, i, start);
    SET_V3(chain, start_normal, i, start_normal);
    AT(chain, start_offset, i) = FIELD_OF(light_vertex, light_vertices, found.start, offset);
    SET_V3(chain, end, i, end);
    SET_V3(chain, end_normal, i, end_normal);
    SET_V3(chain, target, i, point.position);
    SET_V3(chain, target_normal, i, point.geometric);
    AT(chain, target_offset, i) = point.offset;
    AT_UINT(chain, inner, i) = arrives ? found.inner : 0u;
    uint record = last;
    for (uint k = found.inner; k > 0u; --k) {
        const size_t vertex = (size_t)(k - 1u) * chain_rows + i;
        const vec3 position = FIELD_V3(light_vertex, light_vertices, record, position);
        SET_V3(chain_vertex, position, vertex, position);
        AT_UINT(chain_vertex, primitive, vertex) = FIELD_OF(light_vertex_mark, light_vertex_marks, record, primitive);
#if TRAIT_BLENDS
        AT_UINT(chain_vertex, record, vertex) = FIELD_OF(light_vertex_mark, light_vertex_marks, record, material);
#endif
        record = FIELD_OF(light_vertex_mark, light_vertex_marks, record, before);
    }
}
