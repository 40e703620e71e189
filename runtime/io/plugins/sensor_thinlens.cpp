// <sensor type="thinlens">: a perspective camera with a lens.
//   as perspective, without principal points; aperture_radius; focus_distance (far_clip), along the line of sight
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Camera sensor_thinlens(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    read_field_of_view(properties, camera);
    if (!properties.has("aperture_radius"))
        throw properties.error("aperture_radius", "a thinlens needs an aperture_radius");
    camera.aperture_radius = properties.number("aperture_radius", 0, 0, 1e30);
    camera.focus_distance = properties.number("focus_distance", camera.far_clip);
    if (!(camera.focus_distance > 0))
        throw properties.error("focus_distance", "\"focus_distance\" must be above 0");
    // Without an aperture it is a pinhole.
    camera.kind = camera.aperture_radius > 0 ? Camera::Kind::thin_lens : Camera::Kind::perspective;
    return camera;
}

} // namespace gradus
