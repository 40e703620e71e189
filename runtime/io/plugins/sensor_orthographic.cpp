// <sensor type="orthographic">: parallel rays; the film is [-1, 1] wide, and as to_world scales it.
//   to_world; near_clip (0.01), far_clip (10000)
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Camera sensor_orthographic(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    camera.kind = Camera::Kind::orthographic;
    properties.ignore({"focus_distance", "aperture_radius", "fov", "fov_axis"});
    return camera;
}

} // namespace gradus
