// Panes of glass so thin, or so far from the origin, that their two sides are a few units in the last place apart.
#include "runtime/scene/transform.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"
#include "tests/support/stability.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

/// A pane two wide and high, seen aslant from five away, in a constant environment of radiance 1. Its middle is `far`
/// from the origin along each axis; it is turned by 33 degrees where `is_turned`.
Scene pane(double thickness, double far, bool is_turned, std::uint64_t samples) {
    SceneMaker maker(32, samples);
    maker.cube(maker.material(glass(1.5046)));
    const double angle = is_turned ? 33 * 3.14159265358979 / 180 : 0, cosine = std::cos(angle), sine = std::sin(angle);
    for (Vector3 &p : maker.scene.meshes[0].positions) {
        const double x = p.x, z = 0.5 * thickness * p.z;
        p = {float(far + cosine * x + sine * z), float(far + p.y), float(far - sine * x + cosine * z)};
    }
    maker.look({far + 1.5, far + 1, far + 2.5}, {far, far, far}, 40);
    maker.environment(1);
    return maker.scene;
}

struct PaneCase {
    double thickness, far;
    bool is_turned;
};

class ThinPane : public ::testing::TestWithParam<PaneCase> {};

// Each path carries 1 if its rays meet first one side, then the other. A ray that starts beyond the far side finds
// itself outside with glass around it, or inside without. Twice that distance was 8e-6 of the coordinates and size
// once, and took 37 % of the light of all panes below but the first.
TEST_P(ThinPane, LosesNoLight) {
    const PaneCase &c = GetParam();
    constexpr std::uint64_t samples = 64;
    const Spread spread = spread_of(render(pane(c.thickness, c.far, c.is_turned, samples)).image);
    fmt::print("pane of {} at {}: mean {:.6f}, pixels from {:.4f} to {:.4f}\n", c.thickness, c.far, spread.mean,
               spread.least, spread.most);
    // One path in ten thousand may end at the rim, which is no thicker.
    EXPECT_NEAR(spread.mean, 1, 1e-3);
    record_stability({"Numbers", "rays that jump over the far side of what is thin lose its light",
                      fmt::format("a pane of glass {} thick, 2 wide, {} from the origin{}", c.thickness, c.far,
                                  c.is_turned ? ", turned by 33 degrees" : ""),
                      "rays start off surfaces by what that point's rounding takes",
                      "error of the mean in a white furnace", std::fabs(spread.mean - 1), 1e-3});
}

INSTANTIATE_TEST_SUITE_P(Numbers, ThinPane,
                         ::testing::Values(PaneCase{1e-3, 0, false}, PaneCase{2e-6, 0, false}, PaneCase{2e-6, 1, false},
                                           PaneCase{2e-6, 1, true}, PaneCase{4e-3, 2000, false},
                                           PaneCase{4e-3, 2000, true}));

} // namespace
} // namespace gradus::testing
