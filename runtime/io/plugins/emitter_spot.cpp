// <emitter type="spot">: light from one point into a cone about +z, less of it towards its rim.
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace gradus {

Declaration declare_emitter_spot() {
    return {
        "light from one point into a cone about +z, less of it towards its rim",
        joined({{Parameter{"intensity", Takes::emission, "1", "within the beam"}.in("W sr⁻¹"),
                 {"to_world", Takes::transform, nullptr, "from the origin and +z to its place and direction"},
                 Parameter{"cutoff_angle", Takes::number, "20", "where it ends, from the axis; below 90 with a texture"}
                     .in("degrees")
                     .at_least(0)
                     .at_most(180),
                 Parameter{"beam_width", Takes::number, nullptr, "up to where intensity is whole, from the axis"}
                     .in("degrees")
                     .at_least(0)
                     .at_most(180)
                     .or_else("3/4 cutoff_angle"),
                 {"texture", Takes::objects, nullptr,
                  "a picture across the cone, which the intensity is times; to_world does not stretch it"}},
                meaningless({"sampling_weight"})})};
}

Emitter emitter_spot(Properties &properties, SceneBuilder &builder) {
    constexpr double radians = std::numbers::pi / 180;
    Emitter emitter;
    emitter.kind = Emitter::Kind::spot;
    emitter.value = properties.color("intensity");
    const Matrix4 to_world = properties.transform("to_world");
    const Double3 axis = transform_vector(to_world, {0, 0, 1});
    if (!(length(axis) > 0))
        throw properties.error("to_world", "the direction of a spot is zero");
    if (!turned_axes(to_world))
        properties.diagnostics().warn(properties.location_of("to_world"),
                                      "to_world turns and moves a spot; that it stretches does not count");
    emitter.position = place_of(properties, "to_world", transform_point(to_world, {0, 0, 0}));
    emitter.direction = to_float(normalize(axis));
    const double cutoff = properties.number("cutoff_angle");
    const double beam = properties.has("beam_width") ? properties.number("beam_width") : cutoff * 0.75;
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
        check_picture(builder.texture_at(found.index), pictures[0].location);
        Color color(float(found.range.mean[0]), float(found.range.mean[1]), float(found.range.mean[2]));
        color.texture = found.index;
        set_texture(color, emitter);
        read_picture_axes(properties, 1, 1, true, emitter);
        const auto width = float(2 * std::tan(cutoff * radians));
        emitter.picture = {width, width};
    }
    return emitter;
}

} // namespace gradus
