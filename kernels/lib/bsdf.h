/* Every BSDF kind of GRADUS_BSDF_KINDS. Conventions: bsdf_sample.h. bsdf_files.h, which includes the file of each, is
 * made of that list when the project is configured. `specular` serves all Dirac kinds.
 *
 *   bsdf_value K_evaluate(material m, vec3 wi, vec3 wo, int mode)           one pair of directions
 *   bsdf_sample K_sample(material m, vec3 wi, real u_lobe, real u1, real u2, int mode)    u in [0, 1)
 *   rgb K_albedo(material m)                                                rough, for the denoiser's albedo channel */
#ifndef GRADUS_LIB_BSDF_H
#define GRADUS_LIB_BSDF_H
#include "kernels/lib/bsdf_files.h"
#include "kernels/lib/bsdf_specular.h"

#endif
