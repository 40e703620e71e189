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

constexpr double first_wavelength = 360, last_wavelength = 830, wavelength_step = 5; // nm

// CIE 015 (Colorimetry), tables of the 1931 standard observer and of illuminant D65, every 5 nm from 360 to 830.
constexpr ObserverRow observer[] = {{0.0001299, 0.000003917, 0.0006061, 46.6383},
                                    {0.0002321, 0.000006965, 0.001086, 49.3637},
                                    {0.0004149, 0.00001239, 0.001946, 52.0891},
                                    {0.0007416, 0.00002202, 0.003486, 51.0323},
                                    {0.001368, 0.000039, 0.00645, 49.9755},
                                    {0.002236, 0.000064, 0.01055, 52.3118},
                                    {0.004243, 0.00012, 0.02005, 54.6482},
                                    {0.00765, 0.000217, 0.03621, 68.7015},
                                    {0.01431, 0.000396, 0.06785, 82.7549},
                                    {0.02319, 0.00064, 0.1102, 87.1204},
                                    {0.04351, 0.00121, 0.2074, 91.486},
                                    {0.07763, 0.00218, 0.3713, 92.4589},
                                    {0.13438, 0.004, 0.6456, 93.4318},
                                    {0.21477, 0.0073, 1.03905, 90.057},
                                    {0.2839, 0.0116, 1.3856, 86.6823},
                                    {0.3285, 0.01684, 1.62296, 95.7736},
                                    {0.34828, 0.023, 1.74706, 104.865},
                                    {0.34806, 0.0298, 1.7826, 110.936},
                                    {0.3362, 0.038, 1.77211, 117.008},
                                    {0.3187, 0.048, 1.7441, 117.41},
                                    {0.2908, 0.06, 1.6692, 117.812},
                                    {0.2511, 0.0739, 1.5281, 116.336},
                                    {0.19536, 0.09098, 1.28764, 114.861},
                                    {0.1421, 0.1126, 1.0419, 115.392},
                                    {0.09564, 0.13902, 0.81295, 115.923},
                                    {0.05795, 0.1693, 0.6162, 112.367},
                                    {0.03201, 0.20802, 0.46518, 108.811},
                                    {0.0147, 0.2586, 0.3533, 109.082},
                                    {0.0049, 0.323, 0.272, 109.354},
                                    {0.0024, 0.4073, 0.2123, 108.578},
                                    {0.0093, 0.503, 0.1582, 107.802},
                                    {0.0291, 0.6082, 0.1117, 106.296},
                                    {0.06327, 0.71, 0.07825, 104.79},
                                    {0.1096, 0.7932, 0.05725, 106.239},
                                    {0.1655, 0.862, 0.04216, 107.689},
                                    {0.22575, 0.91485, 0.02984, 106.047},
                                    {0.2904, 0.954, 0.0203, 104.405},
                                    {0.3597, 0.9803, 0.0134, 104.225},
                                    {0.43345, 0.99495, 0.00875, 104.046},
                                    {0.51205, 1.0, 0.00575, 102.023},
                                    {0.5945, 0.995, 0.0039, 100.0},
                                    {0.6784, 0.9786, 0.00275, 98.1671},
                                    {0.7621, 0.952, 0.0021, 96.3342},
                                    {0.8425, 0.9154, 0.0018, 96.0611},
                                    {0.9163, 0.87, 0.00165, 95.788},
                                    {0.9786, 0.8163, 0.0014, 92.2368},
                                    {1.0263, 0.757, 0.0011, 88.6856},
                                    {1.0567, 0.6949, 0.001, 89.3459},
                                    {1.0622, 0.631, 0.0008, 90.0062},
                                    {1.0456, 0.5668, 0.0006, 89.8026},
                                    {1.0026, 0.503, 0.00034, 89.5991},
                                    {0.9384, 0.4412, 0.00024, 88.6489},
                                    {0.85445, 0.381, 0.00019, 87.6987},
                                    {0.7514, 0.321, 0.0001, 85.4936},
                                    {0.6424, 0.265, 0.00005, 83.2886},
                                    {0.5419, 0.217, 0.00003, 83.4939},
                                    {0.4479, 0.175, 0.00002, 83.6992},
                                    {0.3608, 0.1382, 0.00001, 81.863},
                                    {0.2835, 0.107, 0.0, 80.0268},
                                    {0.2187, 0.0816, 0.0, 80.1207},
                                    {0.1649, 0.061, 0.0, 80.2146},
                                    {0.1212, 0.04458, 0.0, 81.2462},
                                    {0.0874, 0.032, 0.0, 82.2778},
                                    {0.0636, 0.0232, 0.0, 80.281},
                                    {0.04677, 0.017, 0.0, 78.2842},
                                    {0.0329, 0.01192, 0.0, 74.0027},
                                    {0.0227, 0.00821, 0.0, 69.7213},
                                    {0.01584, 0.005723, 0.0, 70.6652},
                                    {0.01135916, 0.004102, 0.0, 71.6091},
                                    {0.00811092, 0.002929, 0.0, 72.979},
                                    {0.00579035, 0.002091, 0.0, 74.349},
                                    {0.00410946, 0.001484, 0.0, 67.9765},
                                    {0.00289933, 0.001047, 0.0, 61.604},
                                    {0.00204919, 0.00074, 0.0, 65.7448},
                                    {0.00143997, 0.00052, 0.0, 69.8856},
                                    {0.00099995, 0.0003611, 0.0, 72.4863},
                                    {0.000690079, 0.0002492, 0.0, 75.087},
                                    {0.000476021, 0.0001719, 0.0, 69.3398},
                                    {0.000332301, 0.00012, 0.0, 63.5927},
                                    {0.000234826, 0.0000848, 0.0, 55.0054},
                                    {0.0001661505, 0.00006, 0.0, 46.4182},
                                    {0.000117413, 0.0000424, 0.0, 56.6118},
                                    {0.0000830753, 0.00003, 0.0, 66.8054},
                                    {0.0000587065, 0.0000212, 0.0, 65.0941},
                                    {0.0000415099, 0.00001499, 0.0, 63.3828},
                                    {0.00002935326, 0.0000106, 0.0, 63.8434},
                                    {0.00002067383, 0.0000074657, 0.0, 64.304},
                                    {0.00001455977, 0.0000052578, 0.0, 61.8779},
                                    {0.00001025398, 0.0000037029, 0.0, 59.4519},
                                    {0.00000722146, 0.0000026078, 0.0, 55.7054},
                                    {0.00000508587, 0.0000018366, 0.0, 51.959},
                                    {0.00000358165, 0.0000012934, 0.0, 54.6998},
                                    {0.000002522525, 0.00000091093, 0.0, 57.4406},
                                    {0.00000177651, 0.00000064153, 0.0, 58.8765},
                                    {0.00000125114, 0.00000045181, 0.0, 60.3125}};
static_assert(std::size(observer) == 95);

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
    // The observer is made so that the three functions have the same integral; what is left of that is rounding.
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

} // namespace gradus
