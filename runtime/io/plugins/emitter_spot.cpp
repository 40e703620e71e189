// <emitter type="spot">: light from one point into a cone about +z, less of it towards its rim.
//   to_world; intensity within the beam  W sr^-1, 1; cutoff_angle  20 degrees, where it ends;
//   beam_width  three quarters of that, up to where intensity is whole
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Emitter emitter_spot(Properties &properties, SceneBuilder &) {
    constexpr double radians = 3.14159265358979323846 / 180;
    Emitter emitter;
    emitter.kind = Emitter::Kind::spot;
    emitter.value = properties.color("intensity", {1, 1, 1}, ColorUse::emission);
    if (!properties.objects("texture").empty())
        throw properties.error("texture",
                               "a spot with a texture is not supported; without it the spot can be rendered");
    const Matrix4 to_world = properties.transform("to_world");
    const Double3 axis = transform_vector(to_world, {0, 0, 1});
    if (!(length(axis) > 0))
        throw properties.error("to_world", "the direction of a spot is zero");
    emitter.position = to_float(transform_point(to_world, {0, 0, 0}));
    emitter.direction = to_float(normalize(axis));
    const double cutoff = properties.number("cutoff_angle", 20, 0, 180);
    const double beam = properties.number("beam_width", cutoff * 0.75, 0, 180);
    if (!(cutoff > 0))
        throw properties.error("cutoff_angle", "a spot of no width");
    if (beam > cutoff)
        throw properties.error("beam_width", "the beam of a spot is wider than its cutoff_angle");
    emitter.cutoff = float(cutoff * radians);
    emitter.beam = float(beam * radians);
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
