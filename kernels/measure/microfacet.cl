/* A microfacet distribution. In: h, v, alpha_u, alpha_v, u1, u2. Out: D(h), sigma(v), a visible normal of v. */
#include "kernels/lib/microfacet.h"
#include "kernels/measure/function.h"

STAGE measure_microfacet(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const vec3 h = IN_V3(0), v = IN_V3(3);
    OUT(0) = microfacet_density(DISTRIBUTION, h, v3_length_squared(h), IN(6), IN(7));
    OUT(1) = microfacet_projected_area(DISTRIBUTION, v, IN(6), IN(7));
    const vec3 normal = microfacet_sample_visible(DISTRIBUTION, v, IN(6), IN(7), IN(8), IN(9));
    OUT_V3(2, normal);
}
