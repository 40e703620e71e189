// The camera as the kernels read it.
#pragma once

#include "runtime/scene/camera_clips.h"
#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// Half the width, at distance 1, of what a film of that size shows.
double film_tangent(const Camera &camera, double width, double height);

/// The record of GRADUS_CAMERA_FIELDS for a camera and the full film.
std::vector<float> make_camera_record(const Camera &camera, const FilmSettings &film, const CameraClips &clips = {});

} // namespace gradus
