// <sensor type="thinlens">: a perspective camera with a lens.
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_sensor_thinlens() {
    return {"a perspective camera with a lens",
            joined({parameters_of_camera(),
                    parameters_of_field_of_view(),
                    {Parameter{"aperture_radius", Takes::number, nullptr, "of the lens; 0: a pinhole"}
                         .required()
                         .in("lengths")
                         .at_least(0)
                         .at_most(1e30),
                     Parameter{"focus_distance", Takes::number, nullptr, "to what is sharp, along the line of sight"}
                         .in("lengths")
                         .or_else("far_clip")}})};
}

Camera sensor_thinlens(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    read_field_of_view(properties, camera);
    camera.aperture_radius = properties.number("aperture_radius");
    camera.focus_distance = properties.has("focus_distance") ? properties.number("focus_distance") : camera.far_clip;
    if (!(camera.focus_distance > 0))
        throw properties.error("focus_distance", "\"focus_distance\" must be above 0");
    // Without an aperture it is a pinhole.
    camera.kind = camera.aperture_radius > 0 ? Camera::Kind::thin_lens : Camera::Kind::perspective;
    return camera;
}

} // namespace gradus
