// Parameters that several BSDF plugins share.
#pragma once

#include "runtime/io/properties.h"
#include "runtime/scene/scene.h"

namespace gradus {

enum class Microfacet { beckmann, ggx };

/// distribution (beckmann, ggx; beckmann), which it returns, alpha (0.1) or alpha_u and alpha_v. Roughness is kept at
/// 1e-4 or more.
Microfacet read_roughness(Properties &properties, Bsdf &bsdf);
/// int_ior (bk7), ext_ior (air), specular_reflectance (1), specular_transmittance (1).
void read_dielectric(Properties &properties, Bsdf &bsdf);
/// material (none; 0.x: Cu) or eta and k; ext_eta or ext_ior (0.x: air, else vacuum); specular_reflectance (1).
void read_conductor(Properties &properties, Bsdf &bsdf);

} // namespace gradus
