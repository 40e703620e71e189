// <emitter type="projector">: throws a picture from one point, as a camera there would see it.
//   irradiance  of a texture or a colour, W m^-2 over pi on a plane across +z at distance 1; scale  1
//   to_world  without a scale; fov in degrees along fov_axis (x), or focal_length ("50mm"), as those of a camera whose
//   film has the picture's size
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/scene/camera_record.h"

namespace gradus {

Emitter emitter_projector(Properties &properties, SceneBuilder &builder) {
    constexpr float pi = 3.14159265358979f;
    Emitter emitter;
    emitter.kind = Emitter::Kind::projector;
    if (!properties.has("irradiance"))
        throw SceneError(properties.location(), "a projector needs an irradiance, a texture or a colour");
    const Color irradiance = properties.textured_emission("irradiance", {1, 1, 1});
    const float factor = pi * float(properties.number("scale", 1, 0, 1e30));
    emitter.value = {factor, factor, factor};
    if (irradiance.texture == no_texture)
        emitter.value = {factor * irradiance.r, factor * irradiance.g, factor * irradiance.b};
    set_texture(irradiance, emitter);
    read_picture_axes(properties, -1, -1, false, emitter); // as a camera's film: +x to the left, +y up
    double width = 1, height = 1;
    if (irradiance.texture != no_texture)
        if (const auto &bitmap = builder.texture_at(irradiance.texture).bitmap) {
            width = bitmap->width;
            height = bitmap->height;
        }
    Camera camera;
    read_field_of_view(properties, camera);
    const double tangent = film_tangent(camera, width, height);
    emitter.picture = {float(2 * tangent), float(2 * tangent * height / width)};
    properties.ignore({"sampling_weight"});
    return emitter;
}

} // namespace gradus
