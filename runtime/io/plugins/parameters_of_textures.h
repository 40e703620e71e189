// Parameters that several texture plugins share.
#pragma once

#include "runtime/io/properties.h"
#include "runtime/scene/texture.h"

namespace gradus {

/// to_uv (the identity), a map of the surface's (u, v); in 0.x uscale, vscale (1), uoffset and voffset (0).
void read_to_uv(Properties &properties, Texture &texture);

} // namespace gradus
