/* Maps from the unit square. In: u1, u2, 1 - cosine of a cone. Out: directions in hemisphere, sphere and cone,
 * barycentrics. */
#include "kernels/lib/warp.h"
#include "kernels/measure/function.h"

STAGE measure_warp(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const real u1 = IN(0), u2 = IN(1);
    const vec3 hemisphere = warp_cosine_hemisphere(u1, u2);
    OUT_V3(0, hemisphere);
    const vec3 sphere = warp_uniform_sphere(u1, u2);
    OUT_V3(3, sphere);
    const vec3 cone = warp_uniform_cone(IN(2), u1, u2);
    OUT_V3(6, cone);
    const point2 triangle = warp_uniform_triangle(u1, u2);
    OUT(9) = triangle.x;
    OUT(10) = triangle.y;
}
