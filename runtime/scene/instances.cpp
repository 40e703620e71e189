#include "runtime/scene/instances.h"

#include "runtime/scene/parallel.h"

#include <algorithm>
#include <cmath>

// After all others: its short macro names are not for library headers.
#include "kernels/shared/scene_records.h"

namespace gradus {

using namespace lib_float;

namespace {

/// Of the determinant over the product of what the axes become: below it rounding of the inverse, which goes with its
/// square, would be more than a thousandth of the group.
constexpr double least_skew = 1e-3;
/// Normals are mapped by products of two axes, which are squared.
constexpr double least_axis = 1e-8, largest_axis = 1e8;

Double3 absolute(const Double3 &v) { return {std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])}; }

/// Where each coordinate has its largest magnitude in a box.
Double3 largest(const Bounds &box) {
    Double3 result;
    for (std::size_t axis = 0; axis < 3; ++axis)
        result[axis] = std::max(std::fabs(box.lower[axis]), std::fabs(box.upper[axis]));
    return result;
}

using Rows = std::array<Double3, 3>;

Double3 times(const Rows &rows, const Double3 &v) { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }

Rows linear_part(const Matrix4 &m) {
    return {Double3{m.m[0], m.m[1], m.m[2]}, Double3{m.m[4], m.m[5], m.m[6]}, Double3{m.m[8], m.m[9], m.m[10]}};
}

Rows inverse_of(const Matrix4 &m) {
    const Double3 x = column_of(m, 0), y = column_of(m, 1), z = column_of(m, 2);
    const double factor = 1 / determinant(m);
    return {scale(cross(y, z), factor), scale(cross(z, x), factor), scale(cross(x, y), factor)};
}

Rows absolute(const Rows &rows) { return {absolute(rows[0]), absolute(rows[1]), absolute(rows[2])}; }

/// How far rounding may move a point of the group, along each axis of the world. With u = 2^-24, M the map and W its
/// inverse: the tracer takes a ray's origin P to W P + w, whose terms it rounds, with a W that it has computed in
/// single precision; kernels take points p to M p + t. So it is a few u of |M| (|W| |P| + |w| + |p|) + |t|, where W's
/// own error adds the factor |M| |W| once more.
Double3 rounding_of(const Matrix4 &to_world, const Bounds &group) {
    constexpr double units = 4 * 0x1p-24; // as in kernels/lib/ray_start.h
    const Rows map = absolute(linear_part(to_world)), undone = inverse_of(to_world), back = absolute(undone);
    const Double3 origin = column_of(to_world, 3);
    const Double3 world = largest(placed_bounds(group, to_world)), local = largest(group);
    const Double3 of_points = add(add(times(back, world), absolute(times(undone, origin))), local);
    const Double3 of_inverse = times(back, add(world, absolute(origin)));
    const Double3 moved = add(times(map, of_points), times(map, times(back, times(map, of_inverse))));
    return scale(add(moved, absolute(origin)), units);
}

void put_record(const Matrix4 &map, const Double3 &rounding, float *record) {
    const auto put = [&](int field, const Double3 &v) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            record[std::size_t(field) + axis] = float(v[axis]);
    };
    put(instance_x_x, column_of(map, 0));
    put(instance_y_x, column_of(map, 1));
    put(instance_z_x, column_of(map, 2));
    put(instance_origin_x, column_of(map, 3));
    record[instance_facing] = determinant(map) < 0 ? -1.0f : 1.0f;
    put(instance_rounding_x, rounding);
}

} // namespace

bool is_invertible(const Matrix4 &to_world) {
    const double volume = std::fabs(determinant(to_world));
    return std::isnormal(volume) && volume > 1e-12 * length(column_of(to_world, 0)) * length(column_of(to_world, 1)) *
                                                 length(column_of(to_world, 2));
}

bool can_be_instance(const Matrix4 &to_world) {
    double product = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double size = length(column_of(to_world, axis));
        if (!(size >= least_axis && size <= largest_axis))
            return false;
        product *= size;
    }
    for (const double number : to_world.m)
        if (!std::isfinite(float(number)))
            return false;
    return std::fabs(determinant(to_world)) >= least_skew * product;
}

Matrix4 matrix_of(const Instance &instance) {
    Matrix4 matrix;
    std::copy(instance.to_world.begin(), instance.to_world.end(), matrix.m.begin());
    return matrix;
}

Instance make_instance(std::uint32_t group, const Matrix4 &to_world) {
    Instance instance{group, {}};
    std::copy_n(to_world.m.begin(), instance.to_world.size(), instance.to_world.begin());
    return instance;
}

std::vector<Bounds> group_bounds(const Scene &scene) {
    std::vector<Bounds> bounds(scene.groups);
    for (const Shape &shape : scene.shapes)
        if (shape.group != no_group)
            bounds[std::size_t(shape.group)].add(bounds_of(scene, shape));
    return bounds;
}

Bounds placed_bounds(const Bounds &box, const Matrix4 &to_world) {
    Bounds placed;
    if (!(box.lower[0] <= box.upper[0]))
        return placed;
    for (unsigned corner = 0; corner < 8; ++corner) {
        Double3 at;
        for (std::size_t axis = 0; axis < 3; ++axis)
            at[axis] = (corner >> axis & 1u) != 0 ? box.upper[axis] : box.lower[axis];
        const Double3 to = transform_point(to_world, at);
        placed.add(Bounds{to, to});
    }
    return placed;
}

Bounds world_bounds(const Scene &scene) {
    Bounds bounds;
    for (const Shape &shape : scene.shapes)
        if (shape.group == no_group)
            bounds.add(bounds_of(scene, shape));
    const std::vector<Bounds> of_groups = group_bounds(scene);
    for (const Instance &instance : scene.instances)
        bounds.add(placed_bounds(of_groups[instance.group], matrix_of(instance)));
    return bounds;
}

void put_instances(const Scene &scene, float *records) {
    put_record({}, {0, 0, 0}, records);
    const std::vector<Bounds> of_groups = group_bounds(scene);
    for_each_in_parallel(
        scene.instances.size(),
        [&](std::size_t i) {
            const Instance &instance = scene.instances[i];
            const Matrix4 map = matrix_of(instance);
            put_record(map, rounding_of(map, of_groups[instance.group]), records + (i + 1) * instance_stride);
        },
        1 << 12);
}

} // namespace gradus
