/* Value, density and sample of one BSDF kind. In: a material, wi, wo, u_lobe, u1, u2. */
#include "kernels/lib/bsdf.h"
#include "kernels/measure/function.h"

#define MATERIAL_FIELD_IN(name) m.name = IN(material_##name);

STAGE measure_bsdf(MEASURE_ARGUMENTS) {
    MEASURE_ITEM
    material m;
    GRADUS_MATERIAL_FIELDS(MATERIAL_FIELD_IN)
    const vec3 wi = IN_V3(material_stride), wo = IN_V3(material_stride + 3);
    const bsdf_value f = PASTE(BSDF, _evaluate)(m, wi, wo, transport_radiance);
    const bsdf_sample s = PASTE(BSDF, _sample)(m, wi, IN(material_stride + 6), IN(material_stride + 7),
                                               IN(material_stride + 8), transport_radiance);
    OUT(0) = f.value.r;
    OUT(1) = f.value.g;
    OUT(2) = f.value.b;
    OUT(3) = f.pdf;
    OUT_V3(4, s.wo);
    OUT(7) = s.weight.r;
    OUT(8) = s.weight.g;
    OUT(9) = s.weight.b;
    OUT(10) = s.pdf;
    OUT(11) = s.eta;
    OUT(12) = f.pdf_reverse;
}
