// <emitter type="spot">: light from one point into a cone about +z, less of it towards its rim.
//   to_world; intensity within the beam  W sr^-1, 1; cutoff_angle  20 degrees, where it ends;
//   beam_width  three quarters of that, up to where intensity is whole; texture, which the intensity is times: a
//   picture across the cone
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>
#include <limits>

namespace gradus {

Emitter emitter_spot(Properties &properties, SceneBuilder &builder) {
    constexpr double radians = 3.14159265358979323846 / 180;
    Emitter emitter;
    emitter.kind = Emitter::Kind::spot;
    emitter.value = properties.color("intensity", {1, 1, 1}, ColorUse::emission);
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
    if (const auto pictures = properties.objects("texture"); !pictures.empty()) {
        if (pictures.size() > 1)
            throw SceneError(pictures[1].location, "a spot has one texture; this is its second");
        if (!(cutoff < 89.9))
            throw properties.error("cutoff_angle", "a spot with a texture needs a cutoff_angle below 90 degrees");
        const FoundTexture found = builder.texture(*pictures[0].element, 0, std::numeric_limits<float>::max());
        Color color(float(found.range.mean[0]), float(found.range.mean[1]), float(found.range.mean[2]));
        color.texture = found.index;
        set_texture(color, emitter);
        read_picture_axes(properties, 1, 1, true, emitter);
        const auto width = float(2 * std::tan(cutoff * radians));
        emitter.picture = {width, width};
    }
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
