/* light_sample: connects each vertex of one BSDF kind (rows `first` on) to a point of a light chosen by power. Leaves
 * the connection in `shadow`, with what the path gains if nothing is in between. */
#include "kernels/lib/bsdf.h"
#include "kernels/lib/light_sampling.h"
#include "kernels/lib/mis.h"
#include "kernels/lib/vertex_frame.h"
#include "kernels/shared/stage.h"

STAGE light_sample(uint count, uint unit, uint first, uint capacity, uint max_depth, __global const real *vertex,
                   __global const real *tangent, __global real *shadow, __global const real *materials,
                   __global const real *lights, __global const uint *light_kinds, __global const uint *light_alias,
                   uint light_count, real scene_diameter) {
    const size_t i = work_item();
    if (i >= count)
        return;
    const size_t row = first + i;
    const uint depth = AT_UINT(vertex, depth, row);
    const random4 u =
        random_draw(AT_UINT(vertex, key_0, row), AT_UINT(vertex, key_1, row), random_dimension_light(depth));
    const vec3 position = AT_V3(vertex, position, row);
    const chosen_light chosen =
        light_sampling(lights, light_kinds, light_alias, light_count, scene_diameter, unit, position, u);
    const light_choice s = chosen.choice;
    const real probability = chosen.probability;

    const material m = material_load(materials, AT_UINT(vertex, material, row), unit);
    const frame axes = VERTEX_FRAME(row, m);
    const vec3 wi = frame_to_local(axes, AT_V3(vertex, wi, row));
    const vec3 wo = frame_to_local(axes, s.direction);
    const bsdf_value f = PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
    const real weight = mis_weight_light(s.pdf * probability, f.pdf) / probability;
    const rgb gain = rgb_scale(rgb_mul(rgb_mul(AT_RGB(vertex, throughput, row), s.value), f.value), weight);

    CONNECT_TO_LIGHT(row, position, chosen)
    SET_RGB(shadow, value, row, gain);
    AT_UINT(shadow, open, row) = depth + 1u < max_depth && rgb_max(gain) > R(0) ? 1u : 0u;
}
