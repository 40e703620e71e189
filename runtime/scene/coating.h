// What a dielectric coat over a diffuse base does to diffuse light: numbers of materials like plastic that follow from
// index and roughness (kernels/lib/coat.h).
#pragma once

#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// The share of diffuse light that a smooth interface throws back into the denser side, by quadrature, to 1e-6. ior:
/// index inside over index outside, > 0. By reciprocity it is 1 - (1 - R) / ior^2, R the mean from outside.
double internal_reflectance_of_smooth(double ior);

/// Sets internal_reflectance, and for kinds with a rough coat coat_0 and on, from kind, ior and alpha_u.
///
/// The coat's transmittance from outside at cosine mu is the mean over visible normals of (1 - F) G1(refracted), as
/// Mitsuba 3 tabulates it for its `roughplastic`; the polynomial of degree 9 in 2 sqrt(mu) - 1 interpolates it to 1e-3
/// for roughness of 0.05 and more, and to 1e-2 for smoother ones, where it is steep at grazing angles. The internal
/// reflectance is Mitsuba's too: twice the mean of mu times the reflectance from within over 64 even cosines from 0 to
/// 1, ends included, which is about 1 % less than the integral.
/// Where alpha_u is a texture they have that texture too, and no values: coat_records() do.
void set_coating(Bsdf &bsdf);

/// Whether it has a rough coat whose roughness is a texture.
bool has_varying_coat(const Bsdf &bsdf);

/// The BSDF with each of the roughnesses of kernels/lib/rough_coat.h.
std::vector<Bsdf> coat_records(const Bsdf &bsdf);

} // namespace gradus
