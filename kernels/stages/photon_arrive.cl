/* photon_arrive: offset photons have met a surface: places [0, count) of `moved_index`, of pairs of gather points of
 * one BSDF kind. Where one counts at the offset's gather point, and not at the base's, the shift back would find the
 * base photon: both paths are weighed against each other (Hua et al. 2017, eq. 11). Else the base path counts for
 * itself, as photon_shift has left it, and `moved` forgets what was met. */
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/photon_value.h"
#include "kernels/lib/surface_point.h"
#include "kernels/lib/textured_material.h"

STAGE photon_arrive(uint count, uint unit, uint pairs, uint gather_rows, uint pair_rows, uint strip_pixels,
                    __global const uint *moved_index, __global const uint *pair_gather, __global const real *gather,
                    __global real *moved, __global const real *materials, __global const real *triangles,
                    __global const real *triangle_normals, __global const real *triangle_tangents,
                    __global const real *spheres, uint triangle_count, __global const uint *primitive_material,
                    __global const uint *material_back, __global const uint *material_keeps,
                    __global real *pair_difference) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const uint number = moved_index[i], j = moved_offset(number, pairs), pair = number - j * pairs;
    const int row = (int)pair_gather[pair], at = row + (int)((j + 1u) * strip_pixels);
    const uint primitive = AT_UINT(moved, primitive, i);
    const int is_hit = primitive < ray_first_special;
    const vec3 direction = AT_V3(moved, direction, i);
    const surface_point point = surface_point_of(triangles, triangle_normals, triangle_tangents, spheres, unit,
                                                 triangle_count, primitive_material, material_back,
                                                 is_hit ? primitive : 0u, AT_V3(moved, origin, i), direction);
    const photon_disc base_disc = PHOTON_DISC(row), offset_disc = PHOTON_DISC(at);
    const uint gathers = material_keeps[point.material];
    const int is_photon =
        (gathers == gathers_around) | ((gathers == gathers_in_front) & (v3_dot(point.shading, direction) < R(0)));
    const int arrives = is_hit & is_photon & photon_counts(offset_disc, point.position, point.geometric) &
                        !photon_counts(base_disc, point.position, point.geometric);

    const material m = VERTEX_MATERIAL(gather, at);
    const real inverse = R(1) / offset_disc.radius;
    const rgb offset =
        rgb_scale(rgb_mul(PHOTON_VALUE(at, m, v3_neg(direction), point.geometric, AT_RGB(moved, power, i)),
                          AT_RGB(gather, throughput, at)),
                  inverse * inverse);
    const size_t to = (size_t)j * pair_rows + pair;
    const rgb alone = AT_RGB(pair_difference, value, to); /* less the base */
    const real weight = R(1) / (R(1) + AT(moved, ratio, i));
    const rgb difference = rgb_select(arrives, rgb_scale(rgb_add(offset, alone), weight), alone);
    SET_RGB(pair_difference, value, to, difference);
    AT_UINT(moved, primitive, i) = arrives ? primitive : ray_none; /* for photon_count */
}
