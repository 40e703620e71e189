/* photon_leave: chains that have come to their new ends: how their light leaves the vertex that stays, where that is of
 * one BSDF kind, or with LAST_IS_LIGHT on a light. Others are left alone. The Jacobian is by solid angle there:
 * |d omega' / d omega| = |d omega' / dy'| |dy' / dy| |dy / d omega| (Hua et al. 2017, eqs. 7 and 8,
 * and of glossy chains 9 and 10; kernels/lib/chain_spread.h). */
#include "kernels/lib/chain_spread.h"
#include "kernels/lib/light_vertex_leave.h"
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/photon_chain.h"

STAGE photon_leave(uint count, uint unit, uint first, uint pairs, uint photon_rows, uint pair_rows, uint chain_bin,
                   uint light_bin, uint most_inner, uint chain_rows, uint chain_vertices, uint leave_bin,
                   __global const uint *moved_index, __global const uint *pair_photon,
                   __global const real *photon_sorted, __global const real *light_vertices,
                   __global const uint *light_vertex_marks, __global const uint *leaving_bin,
                   __global const real *materials, __global real *moved, __global const real *chain,
                   __global const real *chain_vertex, __global const real *walked,
                   __global const real *walked_vertex LEAVE_PARAMETERS) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    const uint from = pair_photon[pair];
    const photon_chain found = photon_chain_of(light_vertex_marks, leaving_bin, chain_bin, most_inner, unit,
                                               AT_UINT(photon_sorted, before, from));
    const uint record = found.start;
    const uint marked = FIELD_OF(light_vertex_mark, light_vertex_marks, record, material);
    const int is_light = light_vertex_is_light(marked);
    const uint own_bin = is_light ? light_bin : leaving_bin[is_light ? 0u : marked];
    if (own_bin != leave_bin || AT_UINT(walked, outcome, i) != walk_arrived)
        return;
    const vec3 start = VERTEX_V3(position);
    const vec3 was = v3_normalize(v3_sub(AT_V3(chain_vertex, position, i), start));
    const vec3 is = v3_normalize(v3_sub(AT_V3(walked_vertex, position, i), start));
    const light_leaving leaving =
        light_vertex_leave(light_vertices, light_vertex_marks, materials, record, unit, was, is LEAVE_ARGUMENTS);
    const real jacobian = AT(moved, ratio, to) * chain_jacobian(AT(walked, base_spread, i), AT(walked, base_turn, i),
                                                                AT(walked, spread, i), AT(walked, turn, i));
    const rgb power = leaving.is_possible ? rgb_scale(leaving.power, jacobian) : rgb_gray(R(0));
    SET_RGB(moved, power, to, power);
    AT(moved, ratio, to) = leaving.pdf * jacobian;
}
