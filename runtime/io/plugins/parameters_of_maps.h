// What `normalmap` and `bumpmap` share.
#pragma once

#include "runtime/io/plugins/plugin.h"

namespace gradus {

/// But the nested texture, and what one of them has alone.
ParameterList parameters_of_maps();
/// The nested BSDF with the nested texture as its map, which must be one each.
Material read_mapped(Properties &properties, SceneBuilder &builder, NormalTexture::Kind kind);

} // namespace gradus
