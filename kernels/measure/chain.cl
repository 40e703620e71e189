/* A vertex of a chain: what it does, and how its end moves with the first direction. */
#include "kernels/lib/chain_event.h"
#include "kernels/lib/chain_spread.h"
#include "kernels/lib/normal_change.h"
#include "kernels/measure/function.h"

/* In: the first direction, geometric and shading normal at the vertex, normal of the end's plane, half vector, whether
 * it mirrors, index ratio, curvature, distances to the vertex and to the end. Out: spread, turn, wo, whether it
 * succeeds. */
STAGE measure_chain(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const vec3 direction = IN_V3(0), geometric = IN_V3(3), n = IN_V3(6), plane = IN_V3(9);
    const real half_x = IN(12), half_y = IN(13);
    const int reflects = IN(14) > R(0), behind = v3_dot(n, direction) > R(0);
    const vertex_event event = vertex_event_of(v3_neg(direction), n, half_x, half_y, reflects, behind, IN(15));
    normal_change change = normal_change_flat(n);
    change.curvature = IN(16);
    const ray_differential beam = ray_differential_at(ray_differential_begin(direction), direction, IN(17), geometric,
                                                      R(1) / v3_dot(geometric, direction));
    const vec3 out_s =
        vertex_event_change(event, n, half_x, half_y, beam.direction_s, normal_change_along(change, beam.position_s));
    const vec3 out_t = vertex_event_change(event, v3_after(n, out_s.x), half_x, half_y, beam.direction_t,
                                           normal_change_along(change, v3_after(beam.position_t, out_s.x)));
    const real cosine = v3_dot(plane, event.wo);
    const real inverse = R(1) / (r_abs(cosine) > R(1e-6) ? cosine : R(1));
    const vec3 end_s = ray_step_at(beam.position_s, out_s, event.wo, IN(18), plane, inverse);
    const vec3 end_t = ray_step_at(beam.position_t, out_t, v3_after(event.wo, end_s.x), IN(18), plane, inverse);
    OUT(0) = chain_spread(end_s, end_t, event.wo, plane);
    OUT(1) = event.turn;
    OUT_V3(2, event.wo);
    OUT(5) = event.is_valid ? R(1) : R(0);
}
