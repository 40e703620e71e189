// What a guide image is made of beside samples: the camera features of an image.
#pragma once

#include "methods/method.h"
#include "runtime/device/buffer.h"
#include "runtime/film/image.h"

namespace gradus {

/// Albedo, normal and depth of an image in device memory, as FeatureFilter has them.
Buffer uploaded_features(Device &device, const Image &image);

/// Throws Error(ExitCode::usage) where the guide that options ask for is not there: before anything is rendered.
void check_guide(const RenderOptions &options);

} // namespace gradus
