/* Fresnel's equations. */
#include "kernels/lib/fresnel.h"
#include "kernels/measure/function.h"

/* In: cosine, index ratio. Out: reflectance, transmitted cosine. */
MEASURE(measure_fresnel_dielectric)
    const fresnel_dielectric_result f = fresnel_dielectric(IN(0), IN(1));
    OUT(0) = f.reflectance;
    OUT(1) = f.cosine_transmitted;
END_MEASURE

/* In: cosine, eta, k. */
MEASURE(measure_fresnel_conductor)
    OUT(0) = fresnel_conductor(IN(0), IN(1), IN(2));
END_MEASURE
