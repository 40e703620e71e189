/* photon_reconnect: photons whose last vertex is of one BSDF kind and stays where it is: places `first` on of
 * `moved_index`. Sends a ray from there towards where the offset photon must be, with the power that it brings (Hua et
 * al. 2017, eq. 6 and direct reconnection; kernels/lib/shift_photon.h).
 *
 * Nothing is sent where the shift fails, or where the path cannot go that way: then it would not find the way back. */
//! traits: TRAIT_SHADING_NORMALS TRAIT_ANISOTROPIC
#include "kernels/lib/bsdf.h"
#include "kernels/lib/moved_photon.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/light_vertex.h"

#define VERTEX_V3(field) FIELD_V3(light_vertex, light_vertices, record, field)

STAGE photon_reconnect(uint count, uint unit, uint first, uint pairs, uint gather_rows, uint photon_rows,
                       uint pair_rows, uint strip_pixels, __global const uint *moved_index,
                       __global const uint *pair_gather, __global const uint *pair_photon, __global const real *gather,
                       __global const real *photon_sorted, __global const real *light_vertices,
                       __global const uint *light_vertex_marks, __global const real *materials, __global real *moved) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t to = first + i;
    const uint number = moved_index[to], j = moved_offset(number, pairs), pair = number - j * pairs;
    const uint row = pair_gather[pair], from = pair_photon[pair];
    const uint record = AT_UINT(photon_sorted, before, from);
    const vec3 position = VERTEX_V3(position), geometric = VERTEX_V3(geometric);
    const vec3 direction = v3_neg(AT_V3(photon_sorted, wi, from));
    const vec3 origin =
        ray_origin(position, geometric, FIELD_OF(light_vertex, light_vertices, record, offset), direction);
    const shifted_photon shifted = photon_shift_from(origin, AT_V3(photon_sorted, position, from), PHOTON_DISC(row),
                                                     PHOTON_DISC(row + (j + 1u) * strip_pixels));
    const vec3 way = v3_sub(shifted.target, origin);
    const vec3 towards = v3_scale(way, R(1) / r_sqrt(r_max(v3_dot(way, way), R(1e-30))));
    const real cosine = v3_dot(geometric, direction), cosine_offset = v3_dot(geometric, towards);
    const int same_side = cosine * cosine_offset > R(0);

    const material m =
        material_load(materials, FIELD_OF(light_vertex_mark, light_vertex_marks, record, material), unit);
#if TRAIT_SHADING_NORMALS || TRAIT_ANISOTROPIC
    const vec3 shading = VERTEX_V3(shading);
#else
    const vec3 shading = geometric;
#endif
#if TRAIT_ANISOTROPIC
    const frame axes = surface_frame(shading, VERTEX_V3(along), m);
#else
    const frame axes = frame_from_normal(shading);
#endif
    const vec3 back = VERTEX_V3(wi);
    const vec3 wi = frame_to_local(axes, back), wo = frame_to_local(axes, towards);
#if BSDF_IS_DIRAC
    const bsdf_value f = bsdf_value_none();
    (void)wi, (void)wo;
#else
    const bsdf_value f = PASTE(BSDF, _evaluate)(m, wi, wo, transport_importance);
#endif
    real turned = R(1);
#if TRAIT_SHADING_NORMALS
    /* As light paths are (scatter.cl). */
    turned = r_abs(wi.z * cosine_offset) / r_max(r_abs(v3_dot(geometric, back) * wo.z), R(1e-12));
#endif
    const int works = shifted.is_valid & same_side & (f.pdf > R(0)) & (rgb_max(f.value) > R(0));
    const real base_pdf = FIELD_OF(light_vertex, light_vertices, record, pdf);
    const real ratio = shifted.jacobian / r_max(base_pdf, R(1e-30));
    const real survival = FIELD_OF(light_vertex, light_vertices, record, survival);
    const rgb arriving = FIELD_RGB(light_vertex, light_vertices, record, power);
    const rgb power = rgb_scale(rgb_mul(arriving, f.value), ratio * turned / r_max(survival, R(1e-30)));
    SET_V3(moved, origin, to, origin);
    SET_V3(moved, direction, to, towards);
    AT_UINT(moved, primitive, to) = works ? ray_pending : ray_none;
    SET_RGB(moved, power, to, power);
    AT(moved, ratio, to) = f.pdf * ratio;
}
