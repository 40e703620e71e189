/* Fresnel's equations. */
#include "kernels/lib/fresnel.h"
#include "kernels/measure/function.h"

/* In: cosine, index ratio. Out: reflectance, transmitted cosine. */
STAGE measure_fresnel_dielectric(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    const fresnel_dielectric_result f = fresnel_dielectric(IN(0), IN(1));
    OUT(0) = f.reflectance;
    OUT(1) = f.cosine_transmitted;
}

/* In: cosine, eta, k. */
STAGE measure_fresnel_conductor(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    OUT(0) = fresnel_conductor(IN(0), IN(1), IN(2));
}
