#include "runtime/scene/attribute_light.h"

#include "runtime/scene/transform.h"

namespace gradus {

namespace {

std::array<double, 3> mean_of_corners(const Texture &texture, const Mesh &mesh, std::size_t triangle) {
    const MeshAttribute &attribute = *find_attribute(mesh, texture.attribute);
    const auto at = [&](std::size_t element) {
        std::array<double, 3> value;
        for (std::size_t c = 0; c < 3; ++c)
            value[c] = attribute.values[element * attribute.channels + (attribute.channels > 1 ? c : 0)];
        return texture_finished(texture, value);
    };
    if (is_by_face(texture.attribute))
        return at(triangle);
    std::array<double, 3> sum{};
    for (const std::uint32_t corner : mesh.triangles[triangle]) {
        const std::array<double, 3> value = at(corner);
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += value[c] / 3;
    }
    return sum;
}

Rgb to_rgb(const std::array<double, 3> &c) { return {float(c[0]), float(c[1]), float(c[2])}; }

} // namespace

Rgb mean_over_triangle(const Texture &texture, const Mesh &mesh, std::size_t triangle) {
    return to_rgb(mean_of_corners(texture, mesh, triangle));
}

Rgb mean_over_mesh(const Texture &texture, const Mesh &mesh) {
    std::array<double, 3> sum{};
    double area = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto &t = mesh.triangles[i];
        const Double3 p0 = to_double(mesh.positions[t[0]]);
        const double twice =
            length(cross(subtract(to_double(mesh.positions[t[1]]), p0), subtract(to_double(mesh.positions[t[2]]), p0)));
        const std::array<double, 3> mean = mean_of_corners(texture, mesh, i);
        for (std::size_t c = 0; c < 3; ++c)
            sum[c] += twice * mean[c];
        area += twice;
    }
    for (double &value : sum)
        value /= area > 0 ? area : 1;
    return to_rgb(sum);
}

} // namespace gradus
