// The camera as the kernels read it.
#pragma once

#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// The record of GRADUS_CAMERA_FIELDS for a camera and the full film.
std::vector<float> make_camera_record(const Camera &camera, const FilmSettings &film);

} // namespace gradus
