// Spectra and refractive indices.
#include "runtime/io/refractive_index.h"
#include "runtime/io/spectrum.h"
#include "tests/io/scene_text.h"

#include <cmath>

namespace gradus {
namespace {

TEST(Spectrum, FlatReflectanceIsGray) {
    for (const ColorUse use : {ColorUse::reflectance, ColorUse::index})
        expect_rgb(spectrum_to_rgb({{300, 0.4}, {900, 0.4}}, use), 0.4, 0.4, 0.4, 1e-6);
}

TEST(Spectrum, FlatLightIsEqualEnergyWhite) {
    // X = Y = Z = 1 in linear sRGB: the sums of the rows of the matrix of IEC 61966-2-1.
    expect_rgb(spectrum_to_rgb({{300, 1}, {900, 1}}, ColorUse::emission), 1.2048, 0.9483, 0.9087, 2e-4);
}

TEST(Spectrum, DaylightIsWhite) {
    // CIE D65 every 40 nm, relative to its value at 560 nm, so coarse that some per cent of error remain.
    const SampledSpectrum daylight{{380, 0.499755}, {400, 0.827549}, {440, 1.04865},  {480, 1.15923},
                                   {520, 1.0479},   {560, 1.0},      {600, 0.900062}, {640, 0.836992},
                                   {680, 0.782842}, {720, 0.61604},  {780, 0.633828}};
    const Rgb rgb = spectrum_to_rgb(daylight, ColorUse::emission);
    EXPECT_NEAR(rgb.r / rgb.g, 1, 0.03);
    EXPECT_NEAR(rgb.b / rgb.g, 1, 0.03);
}

TEST(Spectrum, AgreesWithMitsuba) {
    // What Mitsuba 3.9 makes of the same spectra in its RGB mode; of a flat reflectance 1 it makes 0.9990, 0.9989,
    // 0.9988.
    const auto expect_reflectance = [](const SampledSpectrum &spectrum, double r, double g, double b) {
        expect_rgb(spectrum_to_rgb(spectrum, ColorUse::reflectance), r / 0.998985, g / 0.998873, b / 0.998803, 2e-4);
    };
    const SampledSpectrum ramp{{400, 0.1}, {500, 0.2}, {600, 0.7}, {700, 0.8}};
    expect_reflectance(ramp, 0.835107, 0.405667, 0.112629);
    expect_rgb(spectrum_to_rgb(ramp, ColorUse::emission), 0.96325, 0.389259, 0.0958685, 2e-4);
    // Nothing outside the samples.
    expect_reflectance({{400, 0.5}, {700, 0.5}}, 0.497671, 0.499878, 0.497455);
    // A line of red, which is out of gamut.
    const SampledSpectrum line{{600, 0}, {610, 0.5}, {620, 0.5}, {630, 0}};
    expect_reflectance(line, 0.192408, 0, 0);
    expect_rgb(spectrum_to_rgb(line, ColorUse::emission), 0.215387, 0, 0, 2e-4);
}

TEST(Spectrum, LuminanceOfALineIsTheObservers) {
    // A triangle of area 1 nm at 550 nm: Y = ybar(550) / (integral of ybar = 106.857 nm).
    const Rgb rgb = spectrum_to_rgb({{549, 0}, {550, 1}, {551, 0}}, ColorUse::emission);
    EXPECT_EQ(rgb.b, 0); // out of gamut
    EXPECT_GT(rgb.g, rgb.r);
    // y = 0.2126 r + 0.7152 g + 0.0722 b before clamping; xyz -> rgb by hand for (0.43345, 0.99495, 0.00875).
    const double green = (-0.969244 * 0.43345 + 1.875968 * 0.99495 + 0.041555 * 0.00875) / 106.857;
    EXPECT_NEAR(rgb.g, green, 0.01 * green);
}

TEST(Spectrum, BlackBodies) {
    // The candela was once defined by platinum that freezes, at 2042 K: 60 cd / cm². 683 lm / W is the luminous
    // efficacy at the observer's peak.
    const Rgb platinum = spectrum_to_rgb(black_body_spectrum(2042), ColorUse::emission);
    const double luminance = 683.0 * 106.857 * (0.2126 * platinum.r + 0.7152 * platinum.g + 0.0722 * platinum.b);
    EXPECT_NEAR(luminance, 60e4, 0.015 * 60e4);
    // Of 5000 K: x = 0.3451, y = 0.3516 (Wyszecki and Stiles 1982, the Planckian locus), times the matrix of sRGB.
    const Rgb warm = spectrum_to_rgb(black_body_spectrum(5000), ColorUse::emission);
    EXPECT_NEAR(warm.r / warm.g, 1.263, 0.01);
    EXPECT_NEAR(warm.b / warm.g, 0.794, 0.01);
}

TEST(Spectrum, BlackBodiesInBothDialects) {
    const Emitter old = load_text(scene_around("<emitter type=\"constant\"><blackbody name=\"radiance\" "
                                               "temperature=\"5000K\" scale=\"2\"/></emitter>",
                                               "0.6.0"))
                            .scene.emitters.at(0);
    const Emitter now = load_text(scene_around("<emitter type=\"constant\"><spectrum type=\"blackbody\" "
                                               "name=\"radiance\"><float name=\"temperature\" value=\"5000\"/>"
                                               "</spectrum></emitter>"))
                            .scene.emitters.at(0);
    const Rgb expected = spectrum_to_rgb(black_body_spectrum(5000), ColorUse::emission);
    expect_rgb(now.value, expected.r, expected.g, expected.b, 1e-6 * expected.r);
    expect_rgb(old.value, 2 * expected.r, 2 * expected.g, 2 * expected.b, 1e-6 * expected.r);
}

TEST(Spectrum, GammaCurve) {
    EXPECT_DOUBLE_EQ(srgb_to_linear_value(0), 0);
    EXPECT_NEAR(srgb_to_linear_value(1), 1, 1e-12);
    EXPECT_NEAR(srgb_to_linear_value(0.5), 0.2140411, 1e-6);
    EXPECT_NEAR(srgb_to_linear_value(0.04), 0.04 / 12.92, 1e-12);
}

double reflectance(double eta, double k) { return ((eta - 1) * (eta - 1) + k * k) / ((eta + 1) * (eta + 1) + k * k); }

struct Measured {
    double wavelength, n, k;
};

/// A table of n and k as the named indices are made: integrated as a light of equal energy.
ConductorIndex integrated(const std::vector<Measured> &table) {
    SampledSpectrum n, k;
    for (const Measured &row : table) {
        n.emplace_back(row.wavelength, row.n);
        k.emplace_back(row.wavelength, row.k);
    }
    return {spectrum_to_rgb(n, ColorUse::emission), spectrum_to_rgb(k, ColorUse::emission)};
}

void expect_ratio_near_one(const Rgb &a, const Rgb &b, double tolerance) {
    expect_rgb({a.r / b.r, a.g / b.g, a.b / b.b}, 1, 1, 1, tolerance);
}

// P. Johnson and R. Christy, Optical Constants of the Noble Metals, Physical Review B 6 (1972).
TEST(RefractiveIndex, NobleMetalsAgreeWithJohnsonAndChristy) {
    const ConductorIndex gold = integrated({{381.5, 1.46, 1.933},
                                            {397.4, 1.47, 1.952},
                                            {413.3, 1.46, 1.958},
                                            {430.5, 1.45, 1.948},
                                            {450.9, 1.38, 1.914},
                                            {471.4, 1.31, 1.849},
                                            {495.9, 1.04, 1.833},
                                            {520.9, 0.62, 2.081},
                                            {548.6, 0.43, 2.455},
                                            {582.1, 0.29, 2.863},
                                            {616.8, 0.21, 3.272},
                                            {659.5, 0.14, 3.697},
                                            {704.5, 0.13, 4.103},
                                            {756.0, 0.14, 4.542},
                                            {821.1, 0.16, 5.083}});
    const ConductorIndex silver = integrated({{381.5, 0.05, 1.864},
                                              {397.4, 0.05, 2.070},
                                              {413.3, 0.05, 2.275},
                                              {430.5, 0.04, 2.462},
                                              {450.9, 0.04, 2.657},
                                              {471.4, 0.05, 2.869},
                                              {495.9, 0.05, 3.093},
                                              {520.9, 0.05, 3.324},
                                              {548.6, 0.06, 3.586},
                                              {582.1, 0.05, 3.858},
                                              {616.8, 0.06, 4.152},
                                              {659.5, 0.05, 4.483},
                                              {704.5, 0.04, 4.838},
                                              {756.0, 0.03, 5.242},
                                              {821.1, 0.04, 5.727}});
    const ConductorIndex copper = integrated({{381.5, 1.34, 2.045},
                                              {397.4, 1.32, 2.116},
                                              {413.3, 1.28, 2.207},
                                              {430.5, 1.25, 2.305},
                                              {450.9, 1.24, 2.397},
                                              {471.4, 1.25, 2.483},
                                              {495.9, 1.22, 2.564},
                                              {520.9, 1.18, 2.608},
                                              {548.6, 1.02, 2.577},
                                              {582.1, 0.70, 2.704},
                                              {616.8, 0.30, 3.205},
                                              {659.5, 0.22, 3.747},
                                              {704.5, 0.21, 4.205},
                                              {756.0, 0.24, 4.665},
                                              {821.1, 0.26, 5.180}});
    // The named ones come from other films. Such measurements of k agree to about a tenth; the small n, which the
    // preparation of the film decides, differs by more and is not compared.
    expect_ratio_near_one(conductor_index("Au")->k, gold.k, 0.1);
    expect_ratio_near_one(conductor_index("Ag")->k, silver.k, 0.1);
    expect_ratio_near_one(conductor_index("Cu")->k, copper.k, 0.1);
}

TEST(RefractiveIndex, AluminiumReflectsAboutNinetyTwoPercent) {
    const std::optional<ConductorIndex> index = conductor_index("Al");
    ASSERT_TRUE(index);
    // Fresh aluminium films across the visible range (Hass 1955).
    for (const auto &[eta, k] : {std::pair{index->eta.r, index->k.r}, std::pair{index->eta.g, index->k.g},
                                 std::pair{index->eta.b, index->k.b}})
        EXPECT_NEAR(reflectance(eta, k), 0.92, 0.012);
}

TEST(RefractiveIndex, Names) {
    EXPECT_DOUBLE_EQ(dielectric_index("bk7").value(), 1.5046);
    EXPECT_DOUBLE_EQ(dielectric_index(" Acrylic Glass ").value(), 1.49);
    EXPECT_DOUBLE_EQ(dielectric_index("water").value(), 1.333);
    EXPECT_DOUBLE_EQ(dielectric_index("diamond").value(), 2.419);
    EXPECT_FALSE(dielectric_index("kryptonite"));
    EXPECT_TRUE(conductor_index("au"));
    EXPECT_NE(conductor_index("Cu_palik")->eta.r, conductor_index("Cu")->eta.r) << "two measurements";
    EXPECT_EQ(conductor_index("W_palik")->eta.r, conductor_index("W")->eta.r);
    EXPECT_TRUE(conductor_index("Ni"));
    for (const char *name : {"AlAs", "AlSb", "MgO", "Se-e", "SiC", "SnTe", "Te-e_palik", "ThF4", "TiO2", "TiO2-e"})
        EXPECT_TRUE(conductor_index(name)) << name;
    EXPECT_NE(conductor_index("TiO2-e_palik")->eta.r, conductor_index("TiO2")->eta.r);
    EXPECT_FALSE(conductor_index("palik"));
    const ConductorIndex mirror = conductor_index("none").value();
    expect_rgb(mirror.eta, 0, 0, 0, 0);
    expect_rgb(mirror.k, 1, 1, 1, 0);
    for (const std::string &name : conductor_names()) {
        const ConductorIndex index = conductor_index(name).value();
        for (const float value : {index.eta.r, index.eta.g, index.eta.b, index.k.r, index.k.g, index.k.b})
            EXPECT_TRUE(value >= 0 && value < 20) << name;
    }
}

} // namespace
} // namespace gradus
