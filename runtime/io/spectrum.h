// Spectra as scene files give them, turned into linear sRGB.
#pragma once

#include "runtime/scene/scene.h"

#include <utility>
#include <vector>

namespace gradus {

/// What a colour stands for. A spectrum of reflectances or refractive indices is averaged under daylight (D65), so
/// that a flat one is gray; a spectrum of light is integrated as it is, so that a flat one is the slightly reddish
/// white of equal energy.
enum class ColorUse { reflectance, index, emission };

/// (wavelength in nm, value), wavelengths strictly rising; linear between and zero outside.
using SampledSpectrum = std::vector<std::pair<double, double>>;

/// Linear sRGB by the CIE 1931 two-degree observer, normalised so that the flat spectrum 1 has luminance 1. Colours
/// out of gamut are clamped to non-negative components.
Rgb spectrum_to_rgb(const SampledSpectrum &spectrum, ColorUse use);

/// In kelvins. What is colder radiates nothing that could be seen, what is hotter more than single precision holds in
/// images.
constexpr double least_temperature = 1, most_temperature = 1e9;
/// What a black body of such a temperature radiates, by Planck's law, where the observer sees anything.
/// Values in W / (m² sr nm).
SampledSpectrum black_body_spectrum(double temperature);

} // namespace gradus
