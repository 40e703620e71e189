// What several sensors read.
#pragma once

#include "runtime/io/properties.h"

namespace gradus {

/// to_world, near_clip (0.01), far_clip (10000); marks what hangs on a sensor and is read by the scene builder.
void read_camera(Properties &properties, Camera &camera);
/// fov in degrees along fov_axis (x), or focal_length ("50mm") of a 35 mm film.
void read_field_of_view(Properties &properties, Camera &camera);

} // namespace gradus
