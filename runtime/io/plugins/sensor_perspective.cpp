// <sensor type="perspective">: a pinhole camera.
#include "runtime/io/plugins/parameters_of_sensors.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_sensor_perspective() {
    return {"a pinhole camera",
            joined({parameters_of_camera(),
                    parameters_of_field_of_view(),
                    {Parameter{"principal_point_offset_x", Takes::number, "0",
                               "how far right of what lies ahead the film's middle looks"}
                         .in("widths of the film"),
                     Parameter{"principal_point_offset_y", Takes::number, "0", "how far below it"}.in(
                         "heights of the film")},
                    meaningless({"focus_distance", "aperture_radius"})})};
}

Camera sensor_perspective(Properties &properties, SceneBuilder &) {
    Camera camera;
    read_camera(properties, camera);
    read_field_of_view(properties, camera);
    camera.principal_x = properties.number("principal_point_offset_x");
    camera.principal_y = properties.number("principal_point_offset_y");
    return camera;
}

} // namespace gradus
