// <sensor type="perspective">: a pinhole camera.
//   to_world; fov in degrees along fov_axis (x), or focal_length ("50mm") of a 35 mm film;
//   principal_point_offset_x, principal_point_offset_y (0); near_clip (0.01), far_clip (10000)
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Camera sensor_perspective(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    read_field_of_view(properties, camera);
    camera.principal_x = properties.number("principal_point_offset_x", 0);
    camera.principal_y = properties.number("principal_point_offset_y", 0);
    properties.ignore({"focus_distance", "aperture_radius"});
    return camera;
}

} // namespace gradus
