// Whether a camera's near and far planes hide anything: hardly ever, and then no kernel needs to know of them.
#pragma once

#include "runtime/scene/scene.h"

namespace gradus {

struct CameraClips {
    bool near_clip = false, far_clip = false;
};

/// Which planes may hide something of the scene: false only where what a plane cuts off lies outside of what the image
/// shows.
CameraClips camera_clips(const Scene &scene);

/// Distances of the planes along the line of sight, from where the camera is. The scale of an orthographic camera's
/// to_world counts for the near one, and for the far one where Mitsuba has it.
double near_plane(const Camera &camera);
double far_plane(const Camera &camera);

} // namespace gradus
