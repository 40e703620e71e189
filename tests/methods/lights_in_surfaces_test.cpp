// Lights that shine from a point which lies in a surface: that surface never stands in their way, however it is turned
// and whichever rays are traced together.
#include "runtime/scene/transform.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

#include <optional>
#include <ostream>

namespace gradus::testing {
namespace {

struct LightCase {
    const char *method;
    Emitter::Kind kind;
    double far;   ///< along each axis, from the origin
    double width; ///< of the surface
    /// Of photons a few come down elsewhere; and shifts go by the size of the scene, and so does the noise that is
    /// left.
    double limit = 0;
};

std::ostream &operator<<(std::ostream &out, const LightCase &c) {
    return out << c.method << (c.kind == Emitter::Kind::spot ? " spot " : " point ") << c.far << ' ' << c.width;
}

constexpr int plates = 6;

/// A light above a floor that is seen from the side, and in a black plate where there is one: plates of other numbers
/// are rounded to lie a little over it or under it.
Scene scene_of(const LightCase &c, std::optional<int> plate) {
    SceneMaker maker(48, 8);
    const auto place = [&](double x, double y, double z) {
        return Vector3{float(c.far + x), float(c.far + y), float(c.far + z)};
    };
    const Vector3 at = place(0.1, 2, -0.2);
    maker.parallelogram(place(-2, 0, -2), {0, 0, 4}, {4, 0, 0}, maker.material(diffuse(0.5)));
    if (plate) {
        // Across no axis, no corner of a triangle at the light; higher where the camera is.
        const float w = float(c.width), along_u = 0.2f + 0.1f * float(*plate), along_v = 0.73f - 0.07f * float(*plate);
        const Vector3 u{0.8f * w, 0.5f * w, 0.6f * w}, v{-0.6f * w, 0.01f * w, 0.8f * w};
        maker.parallelogram({at.x - along_u * u.x - along_v * v.x, at.y - along_u * u.y - along_v * v.y,
                             at.z - along_u * u.z - along_v * v.z},
                            u, v, maker.material(two_sided(diffuse(0))));
    }
    if (c.kind == Emitter::Kind::spot)
        maker.spot({10, 10, 10}, at, {0, -1, 0}, 40, 60);
    else
        maker.point_light({10, 10, 10}, at);
    maker.look({c.far + 3, c.far + 1, c.far + 2}, {c.far, c.far, c.far}, 40);
    return maker.scene;
}

class LightsInSurfaces : public ::testing::TestWithParam<LightCase> {};

TEST_P(LightsInSurfaces, ShineToBothSides) {
    const LightCase &c = GetParam();
    RenderOptions options;
    options.direct_photons = true; // of sppm, and as many as without the plate
    options.photons = 20'000;
    const double expected = spread_of(render(scene_of(c, std::nullopt), options, c.method).image).mean;
    double lost = 0;
    for (int plate = 0; plate < plates; ++plate) {
        const double with = spread_of(render(scene_of(c, plate), options, c.method).image).mean;
        lost = std::max(lost, std::fabs(1 - with / expected));
    }
    fmt::print("share of the light that a surface takes at most: {:.2e}\n", lost);
    EXPECT_LE(lost, c.limit);
    record_stability({"Numbers", "whether a light that lies in a surface shines is left to rounding",
                      fmt::format("{}, a {} in each of 6 plates {} wide, {} from the origin", c.method,
                                  c.kind == Emitter::Kind::spot ? "spot" : "point light", c.width, c.far),
                      "its rays begin and end off it, by what the tracer errs by in meeting that surface",
                      "share of the light that is lost or won, at most", lost, c.limit});
}

INSTANTIATE_TEST_SUITE_P(Numbers, LightsInSurfaces,
                         ::testing::Values(LightCase{"pt", Emitter::Kind::point, 0, 1},
                                           LightCase{"pt", Emitter::Kind::point, 100, 1},
                                           LightCase{"pt", Emitter::Kind::spot, 7, 1000},
                                           LightCase{"gpt", Emitter::Kind::point, 7, 1000, 0.02},
                                           LightCase{"sppm", Emitter::Kind::point, 7, 1000, 1e-4}));

} // namespace
} // namespace gradus::testing
