// What several emitters read.
#pragma once

#include "runtime/io/properties.h"

#include <array>
#include <optional>
#include <string>

namespace gradus {

/// The point at which the parameter puts an emitter. Throws SceneError where single precision holds none so far away.
Vector3 place_of(Properties &properties, const std::string &parameter, const Double3 &point);

/// Where a map takes x, y and z, and by how much it scales them.
struct TurnedAxes {
    std::array<Double3, 3> axes; ///< of length 1
    double size;
};
/// Nothing where it does not scale all directions alike, or to nothing, or shears.
std::optional<TurnedAxes> turned_axes(const Matrix4 &to_world);

/// Of to_world the position, the direction (its z) and the axes of a picture: u along its x times `u_sign`, v along its
/// y times `v_sign`. It may turn, move and mirror; `allows_scale`: and scale all directions alike, which does not
/// count.
void read_picture_axes(Properties &properties, double u_sign, double v_sign, bool allows_scale, Emitter &emitter);
/// Throws SceneError where a picture to throw is a mesh attribute, which only a surface has.
void check_picture(const Texture &picture, const Location &location);
/// The emitter with a texture for what its value is times; black where the texture is.
void set_texture(const Color &texture, Emitter &emitter);

} // namespace gradus
