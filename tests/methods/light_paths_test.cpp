// Light paths: what lights send out, what arrives and what goes on, against closed forms and the path tracer.
#include "tests/methods/light_paths_case.h"

#include <fmt/format.h>

#include <cmath>

namespace gradus::testing {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::uint32_t many = 400'000;

/// Means lie within 4.5 standard errors: a chance of 7e-6 each, and less than 1e-3 for all of this file. Where nothing
/// is left to chance, the rounding of a float's sums and products.
void expect_flux(const Spread &flux, double expected, const std::string &what) {
    EXPECT_NEAR(flux.mean, expected, 4.5 * flux.standard_error + 2e-6 * expected) << what;
}

// A closed room with walls of albedo a that one lamp lights: photons of depth d bear a^(d - 1) of its power.
TEST(LightPathsOf, AFurnaceFollowTheGeometricSeries) {
    for (const int rr_depth : {-1, 5}) {
        SceneMaker maker(4, 1);
        const double albedo = 0.6, radiance = 2;
        maker.cube(maker.material(diffuse(albedo)), -1, true);
        // A one-sided lamp absorbs what its back gets, so it lies close to the ceiling.
        maker.lamp({0, 0.99999f, 0}, 0.5f, 0.25f, float(radiance), maker.material(diffuse(albedo)));
        maker.scene.settings.rr_depth = rr_depth;
        maker.scene.settings.max_depth = 9;
        LightPathsCase light(maker.scene);
        const std::vector<Photon> photons = light.trace(0, many);
        const double power = pi * radiance * 0.125;
        for (std::uint32_t depth = 1; depth <= 8; ++depth)
            expect_flux(
                flux(photons, many, [&](const Photon &p) { return p.depth == depth; }),
                power * std::pow(albedo, depth - 1), fmt::format("depth {} roulette {}", depth, rr_depth));
    }
}

} // namespace
} // namespace gradus::testing
