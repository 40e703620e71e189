// <shape type="cylinder">: open at its ends, its front outside.
#include "runtime/io/plugins/parameters_of_shapes.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>
#include <numbers>

namespace gradus {

Declaration declare_shape_cylinder() {
    return {"open at its ends, its front outside; a prism of 256 sides with the cylinder's area and normals, within "
            "5e-5 of the radius",
            joined({{Parameter{"p0", Takes::point, "0 0 0", "where its axis begins"}.in("lengths"),
                     Parameter{"p1", Takes::point, "0 0 1", "where its axis ends"}.in("lengths"),
                     Parameter{"radius", Takes::number, "1", ""}.in("lengths")},
                    parameters_of_meshes()})};
}

ShapeGeometry shape_cylinder(Properties &properties, SceneBuilder &) {
    const Double3 p0 = properties.point("p0"), axis = subtract(properties.point("p1"), p0);
    const double radius = std::fabs(properties.number("radius"));
    if (!(length(axis) > 0) || !std::isfinite(length(axis)))
        throw properties.error("p1", "a cylinder's p0 and p1 must differ");
    if (!std::isnormal(float(radius)))
        throw properties.error("radius", "a cylinder needs a radius of moderate size");
    // A prism of the cylinder's area, with the cylinder's normals: its surface departs by 5e-5 of the radius, to either
    // side.
    constexpr std::uint32_t sides = 256;
    constexpr double turn = 2 * std::numbers::pi / sides;
    const double outer = turn / 2 / std::sin(turn / 2) * radius;
    const Double3 along = normalize(axis);
    // Where angles are counted from: as Mitsuba's frames have it (Duff et al. 2017).
    const double sign = std::copysign(1.0, along[2]), a = -1 / (sign + along[2]), b = along[0] * along[1] * a;
    const Double3 x = {1 + sign * along[0] * along[0] * a, sign * b, -sign * along[0]};
    const Double3 y = {b, sign + along[1] * along[1] * a, -along[1]};
    Mesh mesh;
    for (std::uint32_t i = 0; i <= sides; ++i) {
        const Double3 normal = add(scale(x, std::cos(i % sides * turn)), scale(y, std::sin(i % sides * turn)));
        for (const double v : {0.0, 1.0}) {
            mesh.positions.push_back(to_float(add(scale(axis, v), scale(normal, outer))));
            mesh.normals.push_back(to_float(normal));
            mesh.texcoords.push_back({float(i) / sides, float(v)});
        }
        if (i == sides)
            break;
        mesh.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 3});
        mesh.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 1});
    }
    MeshOptions options;
    options.front_from_local_winding = true;
    return made_shape_mesh(properties, std::move(mesh), options, p0);
}

} // namespace gradus
