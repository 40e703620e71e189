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
/// diffuse_reflectance (0.5), specular_reflectance (1), int_ior (polypropylene), ext_ior (air), nonlinear (false), and
/// what follows from them. Kind and roughness must be known.
void read_plastic(Properties &properties, Bsdf &bsdf);
/// diffuse_reflectance (0.5), specular_reflectance (0.2): what they add up to is scaled to 0.99 where it exceeds 1, as
/// Mitsuba 0.x does unless ensure_energy_conservation is false.
void read_two_lobes(Properties &properties, Bsdf &bsdf);
/// What the principled models share: base_color (0.5), roughness (0.5), and 0: anisotropic, spec_trans, spec_tint,
/// sheen, sheen_tint, flatness. Sets alpha_u and alpha_v too.
void read_principled(Properties &properties, Bsdf &bsdf);
/// material (none; 0.x: Cu) or eta and k; ext_eta or ext_ior (0.x: air, else vacuum); specular_reflectance (1).
void read_conductor(Properties &properties, Bsdf &bsdf);

} // namespace gradus
