/* Every BSDF kind of GRADUS_BSDF_KINDS: K_eval, K_pdf, K_sample, K_albedo. Conventions: bsdf_sample.h.
 *
 *   rgb K_eval(material m, vec3 wi, vec3 wo)                              f |cos wo|; 0 for delta kinds
 *   real K_pdf(material m, vec3 wi, vec3 wo)                              by solid angle; 0 for delta kinds
 *   bsdf_sample K_sample(material m, vec3 wi, real u_lobe, real u1, real u2)    u in [0, 1)
 *   rgb K_albedo(material m)                                              rough, for the denoiser's albedo channel */
#ifndef GRADUS_LIB_BSDF_H
#define GRADUS_LIB_BSDF_H
#include "kernels/lib/bsdf_conductor.h"
#include "kernels/lib/bsdf_dielectric.h"
#include "kernels/lib/bsdf_diffuse.h"
#include "kernels/lib/bsdf_null.h"
#include "kernels/lib/bsdf_roughconductor.h"
#include "kernels/lib/bsdf_roughdielectric.h"
#endif
