// No input of an adversarial grid gives a value that is not finite, negative, or above its bound.
#include "tests/kernels/bsdf_case.h"
#include "tests/support/stability.h"
#include "tests/support/worse.h"

#include <gtest/gtest.h>
#include <limits>

using namespace gradus::testing;

namespace {

std::vector<lib::vec3> adversarial_directions() {
    std::vector<lib::vec3> directions;
    for (const double angle : {0.0, 1e-6, 1e-3, 1.0, 41.81, 48.19, 60.0, 89.0, 89.99, 89.99999})
        for (const double azimuth : {0.0, 90.0, 213.0})
            for (const double side : {1.0, -1.0}) {
                lib::vec3 w = direction(angle, azimuth);
                w.z *= static_cast<real>(side);
                directions.push_back(w);
            }
    for (const real z : {R(0), R(-0.0), R(1e-30), R(-1e-30), std::numeric_limits<real>::denorm_min()})
        for (const real side : {R(1), R(-1)}) {
            directions.push_back(lib::v3(side, 0, z));
            directions.push_back(lib::v3(0, side, z));
            directions.push_back(lib::v3(R(0.6), side * R(0.8), z));
        }
    return directions;
}

bool is_fine(lib::rgb c, double largest) {
    for (const real x : {c.r, c.g, c.b})
        if (!(x >= 0 && x <= largest))
            return false;
    return true;
}

std::string describe(const Kind &kind, const lib::material &m, lib::vec3 wi, lib::vec3 wo) {
    char text[300];
    std::snprintf(text, sizeof text, "%s alpha %g ior %g eta %g k %g wi (%.9g %.9g %.9g) wo (%.9g %.9g %.9g)",
                  kind.name, double(m.alpha_u), double(m.ior), double(m.eta_g), double(m.k_g), double(wi.x),
                  double(wi.y), double(wi.z), double(wo.x), double(wo.y), double(wo.z));
    return text;
}

} // namespace

TEST(BsdfFinite, EveryFunctionOnAnAdversarialGrid) {
    const std::vector<lib::vec3> directions = adversarial_directions();
    const real last = static_cast<real>(1 - std::ldexp(1.0, -24));
    constexpr double any = std::numeric_limits<real>::max();
    double worst = 0;
    for (const Kind &kind : kinds)
        for (const double alpha : {0.0, 1e-4, 1e-2, 0.3, 1.0, 3.0})
            for (const double ior : {1.0, 1 + 1e-6, 1.0001, 1 / 1.5, 1.5, 2.4}) {
                if (!is_dielectric(kind) && ior != 1.5)
                    continue;
                if (!is_rough(kind) && alpha != 1)
                    continue;
                for (const auto &[eta, k] : {std::pair{0.0, 1.0}, {1.0, 0.0}, {0.2, 3.9}, {0.0, 0.0}, {20.0, 20.0}}) {
                    if (std::string(kind.name).find("conductor") == std::string::npos && eta != 1)
                        continue;
                    lib::material m = white_material_of(kind, alpha, 0.5 * alpha, ior);
                    m.eta_r = m.eta_g = m.eta_b = static_cast<real>(eta);
                    m.k_r = m.k_g = m.k_b = static_cast<real>(k);
                    ASSERT_TRUE(is_fine(kind.albedo(m), 1.001));
                    // Of many lobes, a weight may be that of one over the chance to sample it.
                    const double largest = 1.001 * (has_many_lobes(kind) ? 1000.0 : 1.0) *
                                           std::max(1.0, std::pow(std::max(ior, 1 / ior), 2));
                    for (const lib::vec3 &wi : directions) {
                        for (const lib::vec3 &wo : directions) {
                            const lib::bsdf_value f = kind.evaluate(m, wi, wo);
                            ASSERT_TRUE(is_fine(f.value, any)) << describe(kind, m, wi, wo);
                            ASSERT_TRUE(f.pdf >= 0 && f.pdf <= any) << describe(kind, m, wi, wo);
                            ASSERT_TRUE(f.pdf_reverse >= 0 && f.pdf_reverse <= any) << describe(kind, m, wi, wo);
                        }
                        for (const real u_lobe : {R(0), last})
                            for (const real u1 : {R(0), R(0.5), last})
                                for (const real u2 : {R(0), R(0.25), R(0.6), last}) {
                                    const lib::bsdf_sample s = kind.sample(m, wi, u_lobe, u1, u2);
                                    ASSERT_TRUE(is_fine(s.weight, largest)) << describe(kind, m, wi, s.wo);
                                    if (!has_many_lobes(kind))
                                        worst = worse(worst, double(lib::rgb_max(s.weight)) / largest);
                                    ASSERT_TRUE(s.pdf >= 0 && s.pdf <= any) << describe(kind, m, wi, s.wo);
                                    ASSERT_TRUE(s.pdf_reverse >= 0 && s.pdf_reverse <= any)
                                        << describe(kind, m, wi, s.wo);
                                    ASSERT_NEAR(lib::v3_length_squared(s.wo), 1, 1e-5) << describe(kind, m, wi, s.wo);
                                    ASSERT_TRUE(s.eta > 0 && s.eta < 3);
                                }
                    }
                }
            }
    record_stability({"Path tracing",
                      "BSDFs divide by cosines and half vectors that vanish, and take roots of rounding",
                      "every BSDF, roughness 0 to 3, index ratios at and near 1, directions at and beside poles and "
                      "horizon, random numbers at their ends",
                      "all values, densities and weights are finite; no weight makes energy",
                      "largest weight of a sample over what energy allows", worst, 1});
}
