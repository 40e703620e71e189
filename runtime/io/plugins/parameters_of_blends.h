// Mixtures of materials, which plugins describe in several ways.
#pragma once

#include "runtime/io/scene_builder.h"
#include "runtime/scene/scene.h"

namespace gradus {

/// What absorbs all light.
Bsdf black_bsdf();

/// A mixture of two materials, of which either may be two-sided, have holes or be a mixture again. weight: the share of
/// the second. Throws SceneError at the location where such a mixture is not supported.
Material blended(Material first, Material second, Number weight, SceneBuilder &builder, const Location &location);

} // namespace gradus
