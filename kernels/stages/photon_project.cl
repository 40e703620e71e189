/* photon_project: photons at the end of a chain of specular or glossy vertices: places `first` on of `moved_index`.
 * Where the offset photon must be is found along the normal of the offset gather point's plane, from above (a ray in
 * `moved`), and the base photon must be found likewise (a segment in `moved_link`), or the shift back would find
 * another (kernels/lib/shift_photon.h). */
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/photon_chain.h"

STAGE photon_project(uint count, uint unit, uint first, uint pairs, uint capacity, uint gather_rows, uint photon_rows,
                     uint pair_rows, uint strip_pixels, uint chain_bin, uint most_inner,
                     __global const uint *moved_index, __global const uint *pair_gather,
                     __global const uint *pair_photon, __global const real *gather, __global const real *photon_sorted,
                     __global const uint *light_vertex_marks, __global const uint *leaving_bin, __global real *moved,
                     __global real *moved_link) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    const int row = (int)pair_gather[pair], from = (int)pair_photon[pair], at = row + (int)((j + 1u) * strip_pixels);
    const photon_chain chain = photon_chain_of(light_vertex_marks, leaving_bin, chain_bin, most_inner, unit,
                                               AT_UINT(photon_sorted, before, from));
    const photon_disc base = PHOTON_DISC(row), offset = PHOTON_DISC(at);
    const vec3 photon = AT_V3(photon_sorted, position, from), normal = AT_V3(photon_sorted, normal, from);
    const shifted_photon shifted = photon_shift_along_normal(photon, normal, base, offset);
    const int works = shifted.is_valid & (chain.inner > 0u);
    const vec3 above = v3_mad(shifted.target, offset.radius, offset.normal), down = v3_neg(offset.normal);
    SET_V3(moved, origin, to, above);
    SET_V3(moved, direction, to, down);
    AT_UINT(moved, primitive, to) = works ? ray_pending : ray_none;
    AT(moved, ratio, to) = shifted.jacobian;
    SET_RGB(moved, power, to, rgb_gray(R(0)));
    /* From the photon, moved off its surface, to the height of the radius above the plane. */
    const vec3 apart = v3_sub(photon, base.position);
    const vec3 start = v3_mad(photon, AT(gather, offset, row), normal);
    const real height = base.radius - v3_dot(apart, base.normal);
    const vec3 up = v3_scale(base.normal, height);
    SET_V3(moved_link, origin, i, start);
    SET_V3(moved_link, direction, i, up);
    AT_UINT(moved_link, open, i) = works ? 1u : 0u;
}
