#include "runtime/scene/own_scale.h"

#include "runtime/error.h"
#include "runtime/scene/bounds.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace gradus {
namespace {

constexpr double least_extent = 1e-3, most_extent = 1e6; ///< of scenes that stay as they are
/// Of a shape over the scene.
constexpr double least_share = 1e-9;
/// Of a triangle, twice: its square is then just above the least of floats, in which kernels take it.
constexpr double least_area = 4e-19;
/// Of a triangle's edges over the scene: a shape of `least_share` may have some ten thousand of these. What is smaller
/// still is left over from modelling and not looked after.
constexpr double least_share_of_edge = 1e-11;
/// Past it differences of coordinates overflow.
constexpr double largest_float_extent = 1e37;
/// Of the camera's place over the scene: from farther, all of it is one direction.
constexpr double most_away = 1e15;
/// Of its distance from the scene: from farther, places there are off by hundredths of it.
constexpr double far_away = 1e5;

void multiply(Vector3 &v, float factor) { v = {v.x * factor, v.y * factor, v.z * factor}; }

/// From the box; 0 within it.
double distance(const Bounds &box, const Double3 &point) {
    Double3 outside;
    for (std::size_t axis = 0; axis < 3; ++axis)
        outside[axis] = std::max({box.lower[axis] - point[axis], point[axis] - box.upper[axis], 0.0});
    return length(outside);
}

/// By mesh, what the areas of its triangles are times in the world: of a group's meshes by the two shortest axes of its
/// smallest instance.
std::vector<double> area_factors(const Scene &scene) {
    std::vector<double> of_group(scene.groups, INFINITY);
    for (const Instance &instance : scene.instances) {
        const Matrix4 to_world = matrix_of(instance);
        std::array<double, 3> axes;
        for (std::size_t axis = 0; axis < 3; ++axis)
            axes[axis] = length(column_of(to_world, axis));
        std::ranges::sort(axes);
        double &factor = of_group[instance.group];
        factor = std::min(factor, axes[0] * axes[1]);
    }
    std::vector<double> factors(scene.meshes.size(), 1);
    for (const Shape &shape : scene.shapes)
        if (shape.group != no_group)
            factors[shape.geometry] = of_group[std::size_t(shape.group)];
    return factors;
}

/// Twice the least area of a triangle that is at least so large; infinite where there is none.
double smallest_area(const Scene &scene, double at_least) {
    double least = INFINITY;
    const std::vector<double> factors = area_factors(scene);
    for (std::size_t number = 0; number < scene.meshes.size(); ++number) {
        const Mesh &mesh = scene.meshes[number];
        const double factor = factors[number];
        using Range = tbb::blocked_range<std::size_t>;
        const auto least_of = [&](const Range &range, double found) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Double3 normal = area_vector(mesh, mesh.triangles[i]);
                const double area = factor * std::sqrt(dot(normal, normal));
                if (area >= at_least)
                    found = std::min(found, area);
            }
            return found;
        };
        least = tbb::parallel_reduce(Range(0, mesh.triangles.size(), 1 << 14), least, least_of,
                                     [](double a, double b) { return std::min(a, b); });
    }
    return least;
}

/// A power of two that lengths are multiplied by, of a scene so large: 1 where nothing is too small or too large.
double scale_of(const Scene &scene, double extent) {
    const bool stays = extent >= least_extent && extent <= most_extent;
    const double factor = stays ? 1 : std::exp2(-std::floor(std::log2(extent)));
    const double edge = least_share_of_edge * extent, smallest = smallest_area(scene, edge * edge) * factor * factor;
    if (smallest >= least_area)
        return factor;
    const double needed = std::ceil(0.5 * std::log2(least_area / smallest)),
                 possible = std::floor(std::log2(most_extent / (extent * factor)));
    return factor * std::exp2(std::max(std::min(needed, possible), 0.0));
}

} // namespace

double bring_to_own_scale(Scene &scene, const std::function<void(const std::string &)> &warn) {
    Bounds all;
    double least = INFINITY, most = 0;
    const Shape *smallest = nullptr, *largest = nullptr;
    const auto add = [&](const Bounds &bounds, const Shape &shape) {
        const double extent = bounds.extent();
        if (extent <= 0)
            return;
        all.add(bounds);
        if (extent < least)
            least = extent, smallest = &shape;
        if (extent > most)
            most = extent, largest = &shape;
    };
    std::vector<const Shape *> of_group(scene.groups); // one of each, for its name
    for (const Shape &shape : scene.shapes)
        if (shape.group == no_group)
            add(bounds_of(scene, shape), shape);
        else
            of_group[std::size_t(shape.group)] = &shape;
    const std::vector<Bounds> of_groups = group_bounds(scene);
    for (const Instance &instance : scene.instances)
        add(placed_bounds(of_groups[instance.group], matrix_of(instance)), *of_group[instance.group]);
    if (!smallest)
        return 1;
    const double extent = all.extent();
    if (extent > largest_float_extent)
        throw Error(ExitCode::scene,
                    fmt::format("the scene is {:.3g} large, more than single precision holds; its largest shape is "
                                "{}, {:.3g} large",
                                extent, largest->name, most));
    if (least < least_share * extent)
        throw Error(
            ExitCode::scene,
            fmt::format("{} is {:.3g} large in a scene of {:.3g}, too small a share for single precision to see "
                        "it: leave it out, or make what is large smaller (the largest shape is {}, {:.3g} large)",
                        smallest->name, least, extent, largest->name, most));
    const Double3 eye = transform_point(scene.camera.to_world, {0, 0, 0});
    if (const double away = std::hypot(eye[0], eye[1], eye[2]); !(away <= most_away * extent))
        throw Error(ExitCode::scene,
                    fmt::format("the camera is at {:.3g}, {:.3g}, {:.3g}, too far from a scene of {:.3g} "
                                "for single precision: see its to_world",
                                eye[0], eye[1], eye[2], extent));
    if (const double away = distance(all, eye) / extent; warn && away > far_away)
        warn(fmt::format("the camera is {:.1g} times as far away as the scene is large: outlines are ragged in single "
                         "precision; bring it nearer and widen its fov",
                         away));
    const double factor = scale_of(scene, extent);
    if (factor == 1)
        return 1;
    for (Mesh &mesh : scene.meshes)
        for (Vector3 &p : mesh.positions)
            multiply(p, float(factor));
    for (Instance &instance : scene.instances)
        for (const std::size_t axis : {3u, 7u, 11u})
            instance.to_world[axis] *= float(factor);
    for (Sphere &sphere : scene.spheres) {
        multiply(sphere.center, float(factor));
        sphere.radius *= float(factor);
    }
    for (Material &material : scene.materials)
        for (Bsdf *side : {&material.front, &material.back})
            side->map.scale *= float(factor);
    for (Bsdf &bsdf : scene.blended)
        bsdf.map.scale *= float(factor);
    for (Emitter &emitter : scene.emitters) {
        multiply(emitter.position, float(factor));
        if (emitter.shines_from_a_point())
            for (float Rgb::*channel : {&Rgb::r, &Rgb::g, &Rgb::b})
                emitter.value.*channel = float(emitter.value.*channel * factor * factor);
    }
    Camera &camera = scene.camera;
    const bool scales = camera.kind == Camera::Kind::orthographic; // its film and its near plane with it
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = scales ? 0 : 3; column < 4; ++column)
            camera.to_world.m[row * 4 + column] *= factor;
    const double depth = camera.far_clip - camera.near_clip; // a length in all cases
    for (double *length : {&camera.aperture_radius, &camera.focus_distance})
        *length *= factor;
    camera.near_clip *= scales ? 1 : factor;
    camera.far_clip = camera.near_clip + depth * factor;
    return factor;
}

} // namespace gradus
