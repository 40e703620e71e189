// Reads <transform>: matrix, lookat, translate, rotate and scale, each applied after those before it.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/element.h"
#include "runtime/scene/scene.h"

namespace gradus {

/// The map that a <transform> element describes. Throws SceneError.
Matrix4 read_transform(const Element &transform, Diagnostics &diagnostics);

} // namespace gradus
