// The camera as the kernels read it.
#pragma once

#include "runtime/scene/camera_clips.h"
#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// The record of GRADUS_CAMERA_FIELDS for a camera and the full film, and the filter's table where it has one.
std::vector<float> make_camera_record(const Camera &camera, const FilmSettings &film, const CameraClips &clips = {});

} // namespace gradus
