/* photon_shift: what becomes of each pair of a gather point of one BSDF kind and a photon where the gather point is
 * that of an offset path: offset j = get_global_id(2) (kernels/lib/shift_photon.h).
 *
 * Where the photon counts there as well, it stays where it is: the difference is known at once, and both paths find it
 * with the same density. Where it does not it must be moved: `moved_bin` says of what kind its last vertex is, and the
 * difference is what it is if that fails. It fails at once where the offset path has no gather point, one of another
 * kind, or one that allows fewer edges: the base path then counts for itself, and so it does for the shift back.
 *
 * Differences are without flux_scale. */
#include "kernels/lib/photon_value.h"
#include "kernels/lib/shift_photon.h"
#include "kernels/lib/textured_material.h"
#include "kernels/shared/light_vertex.h"

STAGE photon_shift(uint count, uint unit, uint gather_rows, uint photon_rows, uint pair_rows, uint strip_pixels,
                   __global const uint *pair_gather, __global const uint *pair_photon, __global const real *gather,
                   __global const real *photon_sorted, __global const real *materials, __global const uint *leaving_bin,
                   uint light_bin, __global const uint *light_vertex_marks, __global const real *pair_value,
                   __global real *pair_difference, __global uint *moved_bin) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint j = (uint)get_global_id(2);
    const int row = (int)pair_gather[i], from = (int)pair_photon[i];
    const uint at = row + (j + 1u) * strip_pixels;

    const real base_radius = AT(gather, radius, row), inverse_base = R(1) / base_radius;
    const rgb base =
        rgb_scale(rgb_mul(AT_RGB(pair_value, value, i), AT_RGB(gather, throughput, row)), inverse_base * inverse_base);
    const real offset_radius = AT(gather, radius, at);
    const int is_there = offset_radius > R(0);
    const uint kind = AT_UINT(gather, kind, at);
    const vec3 photon = AT_V3(photon_sorted, position, from), photon_normal = AT_V3(photon_sorted, normal, from);
    const int may_count = is_there & (kind_number(kind) == PASTE(bsdf_kind_, BSDF)) &
                          (AT_UINT(photon_sorted, depth, from) <= AT_UINT(gather, deepest, at));
    const photon_disc disc = photon_disc_of(AT_V3(gather, position, at), AT_V3(gather, geometric, at), offset_radius);
    const int is_shared = may_count & photon_counts(disc, photon, photon_normal);

    const uint there = is_there ? at : (uint)row;
    const material m = VERTEX_MATERIAL(gather, there);
    const real inverse = R(1) / (is_there ? offset_radius : R(1));
    const rgb offset = rgb_scale(
        rgb_mul(PHOTON_VALUE(at, m, AT_V3(photon_sorted, wi, from), photon_normal, AT_RGB(photon_sorted, power, from)),
                AT_RGB(gather, throughput, at)),
        inverse * inverse);
    const rgb alone = rgb_scale(base, offset_radius < R(0) ? R(0) : R(-1));
    const rgb difference = rgb_select(is_shared, rgb_scale(rgb_sub(offset, base), R(0.5)), alone);
    const size_t to = (size_t)j * pair_rows + i;
    SET_RGB(pair_difference, value, to, difference);

    const uint before = AT_UINT(photon_sorted, before, from);
    const int is_known = before != light_vertex_none;
    const uint record = is_known ? before : 0u;
    const uint last = FIELD_OF(light_vertex_mark, light_vertex_marks, record, material);
    const int is_light = light_vertex_is_light(last);
    const uint kind_bin = leaving_bin[is_light ? 0u : last];
    const uint bin = is_light ? light_bin : kind_bin;
    const int is_moved = may_count & !is_shared & is_known & !LIGHT_VERTEX_MIRRORS(record);
    moved_bin[(size_t)j * count + i] = is_moved ? bin : bin_none;
}
