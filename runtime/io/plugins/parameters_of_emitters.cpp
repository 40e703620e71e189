#include "runtime/io/plugins/parameters_of_emitters.h"

#include <cmath>

namespace gradus {

namespace {
/// As uniform_scale() has it: files carry few digits.
constexpr double tolerance = 1e-3;
} // namespace

Vector3 place_of(Properties &properties, const std::string &parameter, const Double3 &point) {
    for (const double number : point)
        if (!std::isfinite(float(number)))
            throw properties.error(parameter, "a " + properties.type() + " emitter cannot be so far away");
    return to_float(point);
}

std::optional<TurnedAxes> turned_axes(const Matrix4 &to_world) {
    TurnedAxes turned;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Double3 unit{};
        unit[axis] = 1;
        turned.axes[axis] = transform_vector(to_world, unit);
    }
    const double size = turned.size = length(turned.axes[2]);
    if (!(size > 0))
        return std::nullopt;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (std::fabs(dot(turned.axes[axis], turned.axes[(axis + 1) % 3])) > tolerance * size * size ||
            std::fabs(length(turned.axes[axis]) - size) > tolerance * size)
            return std::nullopt;
    for (Double3 &axis : turned.axes)
        axis = normalize(axis);
    return turned;
}

void read_picture_axes(Properties &properties, double u_sign, double v_sign, bool allows_scale, Emitter &emitter) {
    const Matrix4 to_world = properties.transform("to_world");
    if (!(length(transform_vector(to_world, {0, 0, 1})) > 0))
        throw properties.error("to_world", "the direction of a " + properties.type() + " is zero");
    const std::optional<TurnedAxes> turned = turned_axes(to_world);
    if (!turned || (!allows_scale && std::fabs(turned->size - 1) > tolerance))
        throw properties.error("to_world", "a " + properties.type() +
                                               " with a picture can be turned, moved and mirrored, not stretched");
    const double signs[] = {u_sign, v_sign, 1};
    for (std::size_t axis = 0; axis < 3; ++axis)
        emitter.axes[axis] = to_float(scale(turned->axes[axis], signs[axis]));
    emitter.position = place_of(properties, "to_world", transform_point(to_world, {0, 0, 0}));
    emitter.direction = emitter.axes[2];
}

void check_picture(const Texture &picture, const Location &location) {
    if (picture.kind == Texture::Kind::mesh_attribute)
        throw SceneError(location, "a picture to throw cannot be a mesh attribute, which only a surface has");
}

void set_texture(const Color &texture, Emitter &emitter) {
    emitter.texture = texture.texture;
    if (texture.r == 0 && texture.g == 0 && texture.b == 0)
        emitter.value = {};
}

} // namespace gradus
