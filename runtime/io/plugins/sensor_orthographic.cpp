// <sensor type="orthographic">: parallel rays; the film is [-1, 1] wide, and as to_world scales it.
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_sensor_orthographic() {
    return {"parallel rays; the film is [−1, 1] wide, and as to_world scales it, which scales near_clip "
            "too, but not what lies from there to far_clip",
            joined({parameters_of_camera(), meaningless({"focus_distance", "aperture_radius", "fov", "fov_axis"})})};
}

Camera sensor_orthographic(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    camera.kind = Camera::Kind::orthographic;
    return camera;
}

} // namespace gradus
