// Parameters that several BSDF plugins share: what they are, and what is read of them.
#pragma once

#include "runtime/io/properties.h"
#include "runtime/scene/scene.h"

namespace gradus {

enum class Microfacet { beckmann, ggx };

/// The distribution of microfacets, which it returns, and their roughness.
ParameterList parameters_of_roughness();
Microfacet read_roughness(Properties &properties, Bsdf &bsdf);
/// Left in files whose surface was rough once.
ParameterList roughness_left_over();
ParameterList parameters_of_dielectric();
void read_dielectric(Properties &properties, Bsdf &bsdf);
ParameterList parameters_of_plastic();
/// SceneBuilder::set_coating() is for what follows from them.
void read_plastic(Properties &properties, Bsdf &bsdf);
ParameterList parameters_of_two_lobes();
void read_two_lobes(Properties &properties, Bsdf &bsdf);
ParameterList parameters_of_principled();
/// What the principled models share. Sets alpha_u and alpha_v too.
void read_principled(Properties &properties, Bsdf &bsdf);
ParameterList parameters_of_conductor();
void read_conductor(Properties &properties, Bsdf &bsdf);

} // namespace gradus
