// What reconstructions take from the host: images in device memory, and the guide that options ask for.
#pragma once

#include "methods/method.h"
#include "runtime/device/buffer.h"
#include "runtime/film/image.h"
#include "solver/poisson_solver.h"
#include "solver/reconstruction.h"

#include <cstddef>
#include <string>

namespace gradus {

/// The three channels of an image in device memory, as PoissonImages has them.
Buffer uploaded(Device &device, const char *name, std::size_t pixels, const PlaneSource &source);

/// Albedo, normal and depth of an image in device memory, as FeatureFilter has them.
Buffer uploaded_features(Device &device, const Image &image);

/// Throws Error(ExitCode::usage) where the guide that options ask for is not there: before anything is rendered.
void check_guide(const RenderOptions &options);

/// Pixels whose R, G or B, the first channels, is no finite number: a reconstruction takes them as missing.
std::uint64_t pixels_without_a_color(const Image &image);

/// note_of_brightness() of R, G and B, the first channels.
std::string note_of_colors(const Image &image);

} // namespace gradus
