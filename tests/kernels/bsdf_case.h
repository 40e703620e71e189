// The BSDF kinds with materials and incident directions: one description for every test of samplers and of energy.
#pragma once

#include "tests/kernels/precision.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace gradus::testing {

/// The functions of one BSDF kind.
struct Kind {
    const char *name;
    int lobes; ///< as in GRADUS_BSDF_KINDS
    bool is_delta, transmits;
    const char *parameters;
    lib::bsdf_value (*evaluate_in)(lib::material, lib::vec3, lib::vec3, int mode);
    lib::bsdf_sample (*sample_in)(lib::material, lib::vec3, real, real, real, int mode);
    lib::rgb (*albedo)(lib::material);

    lib::bsdf_value evaluate(const lib::material &m, lib::vec3 wi, lib::vec3 wo,
                             int mode = lib::transport_radiance) const {
        return evaluate_in(m, wi, wo, mode);
    }
    lib::rgb eval(const lib::material &m, lib::vec3 wi, lib::vec3 wo) const { return evaluate(m, wi, wo).value; }
    real pdf(const lib::material &m, lib::vec3 wi, lib::vec3 wo) const { return evaluate(m, wi, wo).pdf; }
    lib::bsdf_sample sample(const lib::material &m, lib::vec3 wi, real u_lobe, real u1, real u2,
                            int mode = lib::transport_radiance) const {
        return sample_in(m, wi, u_lobe, u1, u2, mode);
    }
};

#define GRADUS_TEST_KIND(name, lobes, transmits, parameters)                                                           \
    Kind{#name,                                                                                                        \
         lobes,                                                                                                        \
         (lobes) == 1,                                                                                                 \
         (transmits) != 0,                                                                                             \
         " " parameters " ",                                                                                           \
         lib::name##_evaluate,                                                                                         \
         lib::name##_sample,                                                                                           \
         lib::name##_albedo},
inline const std::vector<Kind> kinds = {GRADUS_BSDF_KINDS(GRADUS_TEST_KIND)};
#undef GRADUS_TEST_KIND

inline const Kind &kind_named(std::string_view name) {
    for (const Kind &kind : kinds)
        if (name == kind.name)
            return kind;
    throw std::runtime_error("no BSDF kind " + std::string(name));
}

inline bool has_parameter(const Kind &kind, const std::string &name) {
    return std::string(kind.parameters).find(" " + name + " ") != std::string::npos;
}
/// Scatters to both sides.
inline bool transmits(const Kind &kind) { return kind.transmits; }
/// And refracts: with an index ratio.
inline bool is_dielectric(const Kind &kind) {
    return kind.transmits && has_parameter(kind, "ior") && std::string(kind.name) != "principledthin";
}
/// Of a roughness: alpha, or its root.
inline bool is_rough(const Kind &kind) { return has_parameter(kind, "alpha_u") && std::string(kind.name) != "phong"; }
/// Of several lobes, which are sampled with chances of their own: where two overlap a single weight says nothing of
/// energy, only their mean does.
inline bool has_many_lobes(const Kind &kind) {
    const std::string name = kind.name;
    return name.find("plastic") != std::string::npos || name.find("principled") == 0 || name == "phong" ||
           name == "ward" || name == "roughdiffuse";
}

/// White reflectances, a perfect mirror as conductor, glass as dielectric.
inline lib::material white_material(double alpha_u, double alpha_v, double ior = 1.5) {
    lib::material m{};
    m.reflectance_r = m.reflectance_g = m.reflectance_b = 1;
    m.specular_reflectance_r = m.specular_reflectance_g = m.specular_reflectance_b = 1;
    m.specular_transmittance_r = m.specular_transmittance_g = m.specular_transmittance_b = 1;
    m.k_r = m.k_g = m.k_b = 1;
    m.ior = static_cast<real>(ior);
    m.alpha_u = static_cast<real>(alpha_u);
    m.alpha_v = static_cast<real>(alpha_v);
    // Like a smooth coat: light passes as F at normal incidence says, and less of it the more it grazes.
    m.nonlinear = 1;
    m.internal_reflectance = static_cast<real>(std::max(0.0, 1 - 0.95 / (ior * ior)));
    const real passed = static_cast<real>(1 - std::pow((ior - 1) / (ior + 1), 2));
    m.coat_0 = R(0.63) * passed, m.coat_1 = R(0.5) * passed, m.coat_2 = R(-0.16) * passed;
    m.pane_ior = static_cast<real>(ior);
    m.facet_alpha = R(0.4);
    m.exponent = 20;
    m.ward_variant = 2;
    m.roughness = static_cast<real>(std::sqrt(alpha_u));
    m.anisotropic = alpha_u == alpha_v ? 0 : R(0.7);
    m.metallic = R(0.2), m.spec_trans = R(0.5), m.spec_tint = R(0.3);
    m.sheen = R(0.1), m.sheen_tint = R(0.5), m.flatness = R(0.4);
    m.clearcoat = R(0.5), m.clearcoat_gloss = R(0.2), m.diff_trans = R(0.6);
    return m;
}

/// A white material of that kind: those that add up lobes share the light among them.
inline lib::material white_material_of(const Kind &kind, double alpha_u, double alpha_v, double ior = 1.5) {
    lib::material m = white_material(alpha_u, alpha_v, ior);
    const std::string name = kind.name;
    if (name == "phong" || name == "ward") {
        m.reflectance_r = m.reflectance_g = m.reflectance_b = R(0.5);
        m.specular_reflectance_r = m.specular_reflectance_g = m.specular_reflectance_b = R(0.5);
    }
    if (name.find("principled") == 0)
        m.reflectance_r = m.reflectance_g = m.reflectance_b = R(0.8);
    return m;
}

/// A different value in every field that a BSDF reads: gold-like channels, tinted factors.
inline lib::material coloured_material(double alpha_u, double alpha_v, double ior = 1.5) {
    lib::material m = white_material(alpha_u, alpha_v, ior);
    m.reflectance_r = R(0.7), m.reflectance_g = R(0.4), m.reflectance_b = R(0.2);
    m.specular_reflectance_r = R(0.9), m.specular_reflectance_g = R(0.8), m.specular_reflectance_b = R(0.6);
    m.specular_transmittance_r = R(0.5), m.specular_transmittance_g = R(0.75), m.specular_transmittance_b = R(0.95);
    m.eta_r = R(0.18), m.eta_g = R(0.42), m.eta_b = R(1.37);
    m.k_r = R(3.42), m.k_g = R(2.35), m.k_b = R(1.77);
    return m;
}

/// Unit vector at the angle from +z and the azimuth, both in degrees.
inline lib::vec3 direction(double angle, double azimuth) {
    const double theta = angle * M_PI / 180, phi = azimuth * M_PI / 180;
    return lib::v3(static_cast<real>(std::sin(theta) * std::cos(phi)),
                   static_cast<real>(std::sin(theta) * std::sin(phi)), static_cast<real>(std::cos(theta)));
}

/// From [0, 1), as kernels draw it.
inline real draw(std::mt19937_64 &random) { return static_cast<real>(std::ldexp(double(random() >> 40), -24)); }

/// Uniform over the sphere.
inline lib::vec3 draw_direction(std::mt19937_64 &random) {
    const real u1 = draw(random), u2 = draw(random);
    return lib::warp_uniform_sphere(u1, u2);
}

struct BsdfCase {
    std::string name;
    Kind kind;
    lib::material material;
    lib::vec3 wi;
};

/// Every kind that has a density, over roughness (both axes alike and not) and incidence up to grazing; dielectrics
/// from both sides and for three index ratios.
inline std::vector<BsdfCase> bsdf_cases() {
    const double roughness[][2] = {{0.01, 0.01}, {0.1, 0.1}, {0.05, 0.4}, {0.5, 0.5}, {1, 1}};
    std::vector<BsdfCase> cases;
    for (const Kind &kind : kinds) {
        if (kind.is_delta)
            continue;
        for (const double angle : {0.0, 40.0, 85.0, 89.5, 180.0, 140.0, 95.0, 90.5}) {
            if (angle > 90 && !transmits(kind))
                continue;
            // Kinds of many lobes in a part of the cases: their parts are those of others.
            if (has_many_lobes(kind) && (angle == 89.5 || angle == 180 || angle == 90.5))
                continue;
            for (const auto &alpha : roughness) {
                if (has_many_lobes(kind) && is_rough(kind) && alpha[1] != 0.4 && alpha[1] != 0.5)
                    continue;
                if (!is_rough(kind) && alpha[0] != 1)
                    continue;
                const double ior = alpha[0] == 0.5 ? 1.1 : alpha[0] == 0.1 ? 2.4 : 1.5;
                cases.push_back({std::string(kind.name) + " alpha " + std::to_string(alpha[0]) + " " +
                                     std::to_string(alpha[1]) + " ior " + std::to_string(ior) + " incidence " +
                                     std::to_string(angle),
                                 kind, white_material_of(kind, alpha[0], alpha[1], ior), direction(angle, 33)});
            }
        }
    }
    // All cases in float, which renders. In double the formulas are the same ones, and the sanitizers look for faults,
    // which the fourth part of the cases, in steps that meet every kind, shows as well.
#if defined(GRADUS_SANITIZED) || defined(GRADUS_DOUBLE)
    for (std::size_t i = 0; 4 * i < cases.size(); ++i)
        std::swap(cases[i], cases[4 * i]);
    cases.resize((cases.size() + 3) / 4);
#endif
    return cases;
}

} // namespace gradus::testing
