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
            expect_flux(flux(photons, many, [&](const Photon &p) { return p.depth == depth; }),
                        power * std::pow(albedo, depth - 1), fmt::format("depth {} roulette {}", depth, rr_depth));
    }
}

/// A room with all kinds of lights, a smooth mesh in glass, metals, and things that are too smooth to gather at.
Scene room_of_everything() {
    SceneMaker maker(8, 1);
    maker.cube(maker.material(two_sided(diffuse(0.7))), -1, true);
    maker.lamp({0.2f, 0.9f, 0}, 0.5f, 0.25f, 3, maker.material(diffuse(0.2)));
    maker.sphere({-0.6f, -0.5f, 0.2f}, 0.3f, maker.material(glass(1.5)));
    maker.sphere({0.6f, -0.6f, 0.1f}, 0.3f, maker.material(rough_metal(0.02)));
    maker.sphere({0.1f, 0.1f, 0.4f}, 0.2f, maker.material(rough_glass(0.3, 1.5)));
    maker.sphere({0.5f, 0.6f, -0.5f}, 0.1f, maker.material(diffuse(0.5)),
                 maker.emitter(Emitter::Kind::area, {1, 2, 3}));
    maker.point_light({0.3f, 0.2f, 0.1f}, {-0.5f, 0.5f, -0.5f});
    maker.directional_light({1, 1, 0.5f}, {0, -1, 0});
    maker.environment(0.5);
    maker.scene.settings.rr_depth = 5;
    return maker.scene;
}

// Whatever the batch, and wherever a call begins: the same photons, to the last bit and in the same order.
TEST(LightPathsOf, AnyBatchAreTheSame) {
    const Scene scene = room_of_everything();
    constexpr std::uint32_t count = 20'000, middle = 7'001;
    constexpr std::uint64_t first = (std::uint64_t(1) << 32) - 1000; // across the words of a number
    RenderOptions options;
    options.seed = 3;
    LightPathsCase all(scene, options);
    const std::vector<Photon> photons = all.trace(first, count);
    EXPECT_EQ(all.paths.photons(), photons.size());
    ASSERT_GT(photons.size(), count / 2);
    for (std::size_t i = 1; i < photons.size(); ++i)
        ASSERT_TRUE(photons[i - 1].slot < photons[i].slot ||
                    (photons[i - 1].slot == photons[i].slot && photons[i - 1].depth < photons[i].depth));
    for (const std::uint32_t batch : {64u, 1000u, 65'536u}) {
        options.batch_size = batch;
        LightPathsCase other(scene, options);
        EXPECT_TRUE(other.trace(first, count) == photons) << batch;
        // Two calls are one.
        std::vector<Photon> parts = other.trace(first, middle);
        for (Photon photon : other.trace(first + middle, count - middle)) {
            photon.slot += middle;
            parts.push_back(photon);
        }
        EXPECT_TRUE(parts == photons) << batch;
        EXPECT_EQ(other.paths.light_paths(), 2u * count);
    }
    options.seed = 4;
    EXPECT_FALSE(LightPathsCase(scene, options).trace(first, count) == photons);
}

} // namespace
} // namespace gradus::testing
