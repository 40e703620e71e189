// Parameters that several texture plugins share.
#pragma once

#include "runtime/io/pictures_ahead.h"
#include "runtime/io/properties.h"
#include "runtime/io/scene_builder.h"
#include "runtime/scene/texture.h"

namespace gradus {

ParameterList parameters_of_coordinates();
/// By these, the map of the surface's (u, v).
void read_to_uv(Properties &properties, Texture &texture);

/// What gamma says of colours of 8 and 16 bits: whether they are linear. `otherwise`: without one.
Parameter parameter_gamma();
bool is_linear_by_gamma(Properties &properties, bool otherwise);

/// What a bitmap takes of which file. Throws SceneError.
Picture read_picture(Properties &properties, SceneBuilder &builder);

/// The same everywhere, times a factor.
Texture one_color(const Rgb &color, float scale = 1);

} // namespace gradus
