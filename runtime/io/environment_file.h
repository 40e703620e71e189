// Reads the image of an environment emitter.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/image_io.h"
#include "runtime/io/open_file.h"
#include "runtime/scene/environment_map.h"

#include <memory>

namespace gradus {

/// The map of an image file: its channels R, G and B, those of a layer where it has them there alone, else Y or its
/// only one for all three. `are`: its colours of 8 and 16 bits, as in read_image(). Texels that are negative or no
/// number count as 0, infinite ones, and those above 1e30, as the image's largest, each with a warning. Throws
/// SceneError for what cannot be read.
std::shared_ptr<const EnvironmentMap> read_environment(const OpenFile &file, std::uint64_t limits,
                                                       const Location &location, Diagnostics &diagnostics,
                                                       WholeNumbers are = WholeNumbers::srgb);

} // namespace gradus
