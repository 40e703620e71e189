// Reads the image of an environment emitter.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/open_file.h"
#include "runtime/scene/environment_map.h"

#include <memory>

namespace gradus {

/// The map of an image file: its channels R, G and B, or its first one for all three where it lacks them; PNG and JPEG
/// decoded from sRGB. Texels that are negative or no number count as 0, infinite ones, and those above 1e30, as the
/// image's largest, each with a warning. Throws SceneError for what cannot be read.
std::shared_ptr<const EnvironmentMap> read_environment(const OpenFile &file, std::uint64_t limits,
                                                       const Location &location, Diagnostics &diagnostics);

} // namespace gradus
