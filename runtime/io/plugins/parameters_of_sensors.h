// What several sensors read.
#pragma once

#include "runtime/io/properties.h"

namespace gradus {

/// With what hangs on a sensor and is read by the scene builder.
ParameterList parameters_of_camera();
void read_camera(Properties &properties, Camera &camera);
ParameterList parameters_of_field_of_view();
void read_field_of_view(Properties &properties, Camera &camera);

} // namespace gradus
