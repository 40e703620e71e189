#include "runtime/io/spectrum.h"

#include "runtime/scene/transform.h"

#include <algorithm>
#include <cmath>

namespace gradus {

namespace {

struct ObserverRow {
    double x, y, z; // CIE 1931 two-degree colour matching functions
    double d65;     // relative power of CIE standard illuminant D65
};

constexpr double first_wavelength = 380, last_wavelength = 780, wavelength_step = 10; // nm

// CIE 015 (Colorimetry), tables of the 1931 standard observer and of illuminant D65, every 10 nm from 380 to 780.
constexpr ObserverRow observer[] = {{0.001368, 0.000039, 0.006450, 49.9755}, {0.004243, 0.000120, 0.020050, 54.6482},
                                    {0.014310, 0.000396, 0.067850, 82.7549}, {0.043510, 0.001210, 0.207400, 91.4860},
                                    {0.134380, 0.004000, 0.645600, 93.4318}, {0.283900, 0.011600, 1.385600, 86.6823},
                                    {0.348280, 0.023000, 1.747060, 104.865}, {0.336200, 0.038000, 1.772110, 117.008},
                                    {0.290800, 0.060000, 1.669200, 117.812}, {0.195360, 0.090980, 1.287640, 114.861},
                                    {0.095640, 0.139020, 0.812950, 115.923}, {0.032010, 0.208020, 0.465180, 108.811},
                                    {0.004900, 0.323000, 0.272000, 109.354}, {0.009300, 0.503000, 0.158200, 107.802},
                                    {0.063270, 0.710000, 0.078250, 104.790}, {0.165500, 0.862000, 0.042160, 107.689},
                                    {0.290400, 0.954000, 0.020300, 104.405}, {0.433450, 0.994950, 0.008750, 104.046},
                                    {0.594500, 0.995000, 0.003900, 100.000}, {0.762100, 0.952000, 0.002100, 96.3342},
                                    {0.916300, 0.870000, 0.001650, 95.7880}, {1.026300, 0.757000, 0.001100, 88.6856},
                                    {1.062200, 0.631000, 0.000800, 90.0062}, {1.002600, 0.503000, 0.000340, 89.5991},
                                    {0.854450, 0.381000, 0.000190, 87.6987}, {0.642400, 0.265000, 0.000050, 83.2886},
                                    {0.447900, 0.175000, 0.000020, 83.6992}, {0.283500, 0.107000, 0.000000, 80.0268},
                                    {0.164900, 0.061000, 0.000000, 80.2146}, {0.087400, 0.032000, 0.000000, 82.2778},
                                    {0.046770, 0.017000, 0.000000, 78.2842}, {0.022700, 0.008210, 0.000000, 69.7213},
                                    {0.011359, 0.004102, 0.000000, 71.6091}, {0.005790, 0.002091, 0.000000, 74.3490},
                                    {0.002899, 0.001047, 0.000000, 61.6040}, {0.001440, 0.000520, 0.000000, 69.8856},
                                    {0.000690, 0.000249, 0.000000, 75.0870}, {0.000332, 0.000120, 0.000000, 63.5927},
                                    {0.000166, 0.000060, 0.000000, 46.4182}, {0.000083, 0.000030, 0.000000, 66.8054},
                                    {0.000042, 0.000015, 0.000000, 63.3828}};
static_assert(std::size(observer) == 41);

ObserverRow observer_at(double wavelength) {
    const double position = (wavelength - first_wavelength) / wavelength_step;
    const std::size_t i = std::min(std::size_t(position), std::size(observer) - 2);
    const double t = position - double(i);
    const ObserverRow &a = observer[i], &b = observer[i + 1];
    return {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z), a.d65 + t * (b.d65 - a.d65)};
}

double value_at(const SampledSpectrum &spectrum, double wavelength) {
    const auto above = std::lower_bound(spectrum.begin(), spectrum.end(), wavelength,
                                        [](const auto &sample, double w) { return sample.first < w; });
    if (above == spectrum.end())
        return 0;
    if (above->first == wavelength)
        return above->second;
    if (above == spectrum.begin())
        return 0;
    const auto below = above - 1;
    const double t = (wavelength - below->first) / (above->first - below->first);
    return below->second + t * (above->second - below->second);
}

/// XYZ to linear sRGB (IEC 61966-2-1).
Double3 xyz_to_rgb(const Double3 &xyz) {
    return {3.240970 * xyz[0] - 1.537383 * xyz[1] - 0.498611 * xyz[2],
            -0.969244 * xyz[0] + 1.875968 * xyz[1] + 0.041555 * xyz[2],
            0.055630 * xyz[0] - 0.203977 * xyz[1] + 1.056972 * xyz[2]};
}

} // namespace

Rgb spectrum_to_rgb(const SampledSpectrum &spectrum, ColorUse use) {
    // Sums of the spectrum, of the flat spectrum 1 and of equal energy, midpoints every half nanometre.
    constexpr double step = 0.5;
    Double3 sum{0, 0, 0}, flat{0, 0, 0}, equal{0, 0, 0};
    for (double wavelength = first_wavelength + step / 2; wavelength < last_wavelength; wavelength += step) {
        const ObserverRow row = observer_at(wavelength);
        const Double3 matching{row.x, row.y, row.z};
        const Double3 weight = scale(matching, use == ColorUse::emission ? 1 : row.d65);
        sum = add(sum, scale(weight, value_at(spectrum, wavelength)));
        flat = add(flat, weight);
        equal = add(equal, matching);
    }
    // The observer is made so that the three functions have the same integral; a table every 10 nm misses that by 1e-3.
    for (int i = 0; i < 3; ++i) {
        sum[i] /= equal[i];
        flat[i] /= equal[i];
    }
    Double3 rgb = xyz_to_rgb(scale(sum, 1 / flat[1]));
    if (use != ColorUse::emission) {
        // The white of D65 is that of sRGB to about 1e-3; take out the rest so that flat is exactly gray.
        const Double3 white = xyz_to_rgb(scale(flat, 1 / flat[1]));
        for (int i = 0; i < 3; ++i)
            rgb[i] /= white[i];
    }
    return {float(std::max(rgb[0], 0.0)), float(std::max(rgb[1], 0.0)), float(std::max(rgb[2], 0.0))};
}

SampledSpectrum black_body_spectrum(double temperature) {
    // Planck's law; the constants are exact by the definition of the units of 2019.
    constexpr double light_speed = 299792458, planck = 6.62607015e-34, boltzmann = 1.380649e-23;
    constexpr double per_nanometre = 1e-9, step = 1; // nm
    SampledSpectrum spectrum;
    for (double nanometres = first_wavelength; nanometres <= last_wavelength; nanometres += step) {
        const double wavelength = nanometres * 1e-9;
        const double photon = planck * light_speed / wavelength; // J
        spectrum.emplace_back(nanometres, 2 * photon * light_speed / std::pow(wavelength, 4) /
                                              std::expm1(photon / (boltzmann * temperature)) * per_nanometre);
    }
    return spectrum;
}

double srgb_to_linear(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

} // namespace gradus
