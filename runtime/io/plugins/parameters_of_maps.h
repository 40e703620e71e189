// What `normalmap` and `bumpmap` share.
#pragma once

#include "runtime/io/plugins/plugin.h"

namespace gradus {

/// The nested BSDF with the nested texture as its map, which must be one each: scale 1 (of a bump map),
/// flip_invalid_normals and use_shadowing_function (true; false in 0.x files, whose program has neither).
Material read_mapped(Properties &properties, SceneBuilder &builder, NormalTexture::Kind kind);

} // namespace gradus
