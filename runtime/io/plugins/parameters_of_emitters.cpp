#include "runtime/io/plugins/parameters_of_emitters.h"

#include <cmath>

namespace gradus {

void read_picture_axes(Properties &properties, double u_sign, double v_sign, bool allows_scale, Emitter &emitter) {
    const Matrix4 to_world = properties.transform("to_world");
    std::array<Double3, 3> axes;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        Double3 unit{};
        unit[axis] = 1;
        axes[axis] = transform_vector(to_world, unit);
    }
    const double size = length(axes[2]), signs[] = {u_sign, v_sign, 1};
    constexpr double tolerance = 1e-4;
    if (!(size > 0))
        throw properties.error("to_world", "the direction of a " + properties.type() + " is zero");
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::fabs(dot(axes[axis], axes[(axis + 1) % 3])) > tolerance * size * size ||
            std::fabs(length(axes[axis]) - size) > tolerance * size ||
            (!allows_scale && std::fabs(size - 1) > tolerance))
            throw properties.error("to_world", "a " + properties.type() +
                                                   " with a picture can be turned, moved and mirrored, not stretched");
        emitter.axes[axis] = to_float(scale(axes[axis], signs[axis] / size));
    }
    emitter.position = to_float(transform_point(to_world, {0, 0, 0}));
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
