/* photon_reconnect: photons whose last vertex is of one BSDF kind, or with LAST_IS_LIGHT on a light, and stays where it
 * is: places `first` on of `moved_index`. Sends a ray from there towards where the offset photon must be, with the
 * power that it brings (Hua et al. 2017, eq. 6 and direct reconnection; kernels/lib/shift_photon.h).
 *
 * Nothing is sent where the shift fails, or where the path cannot go that way: then it would not find the way back. */
#include "kernels/lib/chain_start.h"
#include "kernels/lib/light_vertex_leave.h"
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/ray_start.h"

STAGE photon_reconnect(uint count, uint unit, uint first, uint pairs, uint gather_rows, uint photon_rows,
                       uint pair_rows, uint strip_pixels, __global const uint *moved_index,
                       __global const uint *pair_gather, __global const uint *pair_photon, __global const real *gather,
                       __global const real *photon_sorted, __global const real *light_vertices,
                       __global const uint *light_vertex_marks, __global const real *materials,
                       __global real *moved LEAVE_PARAMETERS) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    const int row = (int)pair_gather[pair], from = (int)pair_photon[pair];
    const uint record = AT_UINT(photon_sorted, before, from);
    const vec3 position = VERTEX_V3(position), geometric = VERTEX_V3(geometric);
    const vec3 direction = v3_neg(AT_V3(photon_sorted, wi, from));
    vec3 origin = ray_origin(position, geometric, VERTEX_REAL(offset), direction);
    const photon_disc base = PHOTON_DISC(row), offset = PHOTON_DISC(row + (j + 1u) * strip_pixels);
    const vec3 photon = AT_V3(photon_sorted, position, from);
    shifted_photon shifted = photon_shift_from(origin, photon, base, offset);
    const vec3 way = v3_sub(shifted.target, origin);
    vec3 towards = v3_scale(way, R(1) / r_sqrt(r_max(v3_dot(way, way), R(1e-30))));
#if LAST_IS_LIGHT && LIGHTS_AT_INFINITY
    const int is_far = chain_start_is_far(VERTEX_REAL(offset));
    const shifted_photon parallel = photon_shift_parallel(direction, photon, base, offset);
    shifted.is_valid = is_far ? parallel.is_valid : shifted.is_valid;
    shifted.jacobian = is_far ? parallel.jacobian : shifted.jacobian;
    const vec3 beside = v3_sub(parallel.target, position);
    const vec3 start = v3_mad(parallel.target, -v3_dot(beside, direction), direction);
    origin = v3_select(is_far, start, origin);
    towards = v3_select(is_far, direction, towards);
#endif
    const light_leaving leaving = light_vertex_leave(light_vertices, light_vertex_marks, materials, record, unit,
                                                     direction, towards LEAVE_ARGUMENTS);
    const rgb power = rgb_scale(leaving.power, shifted.jacobian);
    SET_V3(moved, origin, to, origin);
    SET_V3(moved, direction, to, towards);
    AT_UINT(moved, primitive, to) = shifted.is_valid & leaving.is_possible ? ray_pending : ray_none;
    SET_RGB(moved, power, to, power);
    AT(moved, ratio, to) = leaving.pdf * shifted.jacobian;
}
