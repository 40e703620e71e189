// What several emitters read.
#pragma once

#include "runtime/io/properties.h"

namespace gradus {

/// Of to_world the position, the direction (its z) and the axes of a picture: u along its x times `u_sign`, v along its
/// y times `v_sign`. It may turn, move and mirror; `allows_scale`: and scale all directions alike, which does not
/// count.
void read_picture_axes(Properties &properties, double u_sign, double v_sign, bool allows_scale, Emitter &emitter);
/// Throws SceneError where a picture to throw is a mesh attribute, which only a surface has.
void check_picture(const Texture &picture, const Location &location);
/// The emitter with a texture for what its value is times; black where the texture is.
void set_texture(const Color &texture, Emitter &emitter);

} // namespace gradus
