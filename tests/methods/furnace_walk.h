// What a convex object of one BSDF reflects and transmits of a constant environment of radiance 1: an oracle for the
// furnace tests. Random walks on the host, in double, on a sphere or cube whose intersections have closed forms: of
// the renderer it shares the BSDF functions alone, and no stage, table, light sampling or tracer.
#pragma once

#include "runtime/scene/scene.h"

#include <array>

namespace gradus::testing {

enum class ConvexShape { sphere, cube }; ///< the unit sphere, or the cube [-1, 1]^3 of SceneMaker::cube

/// The camera of a square image, every pixel of which must see the object.
struct View {
    std::array<double, 3> from; ///< it looks at the origin, +y up
    double fov;                 ///< degrees
};

struct WalkMean {
    std::array<double, 3> mean{}, standard_error{}; ///< R, G, B, over the image
};

WalkMean walk(ConvexShape shape, const Bsdf &bsdf, const View &view, int walks);

} // namespace gradus::testing
