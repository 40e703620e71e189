// <emitter type="projector">: throws a picture from one point, as a camera there would see it.
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/scene/camera_record.h"

#include <numbers>

namespace gradus {

Declaration declare_emitter_projector() {
    return {"throws a picture from one point, as a camera there would see it, of a film of the picture's size. As in "
            "Mitsuba 3, a wall of albedo 1 across its axis at distance 1 has the picture's values as its radiance",
            joined({{Parameter{"irradiance", Takes::textured_emission, nullptr,
                               "the picture, times π on a plane across +z at distance 1"}
                         .required()
                         .in("W m⁻²"),
                     Parameter{"scale", Takes::number, "1", "what the picture is times"}.at_least(0).at_most(1e30),
                     {"to_world", Takes::transform, nullptr, "turned, moved and mirrored, not stretched"}},
                    parameters_of_field_of_view(),
                    meaningless({"sampling_weight"})})};
}

Emitter emitter_projector(Properties &properties, SceneBuilder &builder) {
    constexpr auto pi = std::numbers::pi_v<float>;
    Emitter emitter;
    emitter.kind = Emitter::Kind::projector;
    const Color irradiance = properties.color("irradiance");
    const float factor = pi * float(properties.number("scale"));
    emitter.value = {factor, factor, factor};
    if (irradiance.texture == no_texture)
        emitter.value = {factor * irradiance.r, factor * irradiance.g, factor * irradiance.b};
    set_texture(irradiance, emitter);
    read_picture_axes(properties, -1, -1, false, emitter); // as a camera's film: +x to the left, +y up
    double width = 1, height = 1;
    if (irradiance.texture != no_texture) {
        check_picture(builder.texture_at(irradiance.texture), properties.location_of("irradiance"));
        if (const auto &bitmap = builder.texture_at(irradiance.texture).bitmap) {
            width = bitmap->width;
            height = bitmap->height;
        }
    }
    Camera camera;
    read_field_of_view(properties, camera);
    const double tangent = film_tangent(camera, width, height);
    emitter.picture = {float(2 * tangent), float(2 * tangent * height / width)};
    return emitter;
}

} // namespace gradus
