// Instances of shapegroups: copies in the file's order first, from which those that are kept as instances are taken
// back.
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"
#include "runtime/scene/bounds.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/own_origin.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gradus {

namespace {
/// What a copy of a shape takes beside its mesh.
constexpr std::uint64_t copied_shape_bytes = 256;
/// What an instance takes in the scene, in the device's tables, and in Embree's.
constexpr std::uint64_t kept_instance_bytes = 512;

/// What has been built already, at another place.
BuiltMesh placed_mesh(BuiltMesh built, const Matrix4 &to_world) {
    MeshOptions options;
    options.front_from_local_winding = true;
    options.compute_normals = false;
    options.normals_keep_proportions = !(uniform_scale(to_world) > 0);
    BuiltMesh placed = build_mesh(std::move(built.mesh), to_world, options);
    placed.degenerate += built.degenerate;
    return placed;
}
} // namespace

SceneBuilder::KnownGroup &SceneBuilder::known_group(const Element &element) {
    const auto [known, is_new] = groups_.try_emplace(&element);
    if (!is_new)
        return known->second;
    std::vector<const Element *> shapes;
    for (const NestedObject &shape : nested_objects(element, "shape", resolve_))
        shapes.push_back(shape.element);
    std::vector<Prototype> prototypes;
    build_shapes(shapes, &prototypes);
    KnownGroup &group = known->second;
    group.origin = settle_origin(prototypes);
    for (Prototype &prototype : prototypes)
        if (const auto *built = std::get_if<BuiltMesh>(&prototype.geometry)) {
            prototype.can_be_kept = nested_objects(*prototype.element, "emitter", resolve_).empty();
            if (prototype.can_be_kept)
                group.bytes += mesh_bytes(built->mesh) + copied_shape_bytes;
        }
    group.prototypes = std::move(prototypes);
    return group;
}

/// Makes shapes relative to one origin, which is returned: near all of them where they are far from that of their
/// frame, so that positions have the bits that the group needs, wherever in its file it was modelled.
Double3 SceneBuilder::settle_origin(std::vector<Prototype> &prototypes) {
    Bounds all;
    for (const Prototype &prototype : prototypes) {
        Bounds bounds;
        if (const auto *sphere = std::get_if<Sphere>(&prototype.geometry))
            bounds.add(sphere->center, sphere->radius);
        else
            bounds = bounds_of(std::get<BuiltMesh>(prototype.geometry).mesh);
        all.add({add(bounds.lower, prototype.origin), add(bounds.upper, prototype.origin)});
    }
    const Double3 origin = own_origin_of(all);
    for (Prototype &prototype : prototypes) {
        const Double3 by = subtract(prototype.origin, origin);
        if (by == Double3{0, 0, 0})
            continue;
        if (auto *built = std::get_if<BuiltMesh>(&prototype.geometry)) {
            *built = placed_mesh(std::move(*built), translation(by));
            continue;
        }
        Vector3 &center = std::get<Sphere>(prototype.geometry).center;
        center = to_float(add(to_double(center), by));
    }
    return origin;
}

/// The prototype becomes a shape where the instance, `element`, has it.
void SceneBuilder::copy_prototype(const Element &element, const Prototype &prototype, const Matrix4 &to_world) {
    count_geometry(copied_shape_bytes, element.location);
    if (const auto *sphere = std::get_if<Sphere>(&prototype.geometry)) {
        const double factor = uniform_scale(to_world);
        if (!(factor > 0))
            throw SceneError(element.location, "an instance with a sphere in it must scale all directions alike: no "
                                               "other scale, no shear");
        Sphere placed = *sphere;
        placed.center = to_float(transform_point(to_world, to_double(sphere->center)));
        placed.radius = float(sphere->radius * factor);
        for (Vector3 &axis : placed.axes)
            axis = to_float(scale(transform_vector(to_world, to_double(axis)), 1 / factor));
        if (!std::isnormal(placed.radius) || !std::isfinite(placed.center.x + placed.center.y + placed.center.z))
            throw SceneError(element.location, "a sphere in this instance is out of range");
        add_shape(*prototype.element, placed);
        return;
    }
    const auto &mesh = std::get<BuiltMesh>(prototype.geometry).mesh;
    if (geometry_bytes_ + mesh_bytes(mesh) > limits_.geometry_bytes) // before it takes the memory
        count_geometry(mesh_bytes(mesh), element.location);
    add_shape(*prototype.element, placed_mesh(std::get<BuiltMesh>(prototype.geometry), to_world));
}

/// `element`: the instance. The first of each group is a copy, and so are others as long as copies are small; what
/// instances cannot be is always copied.
void SceneBuilder::add_instance(const Element &element, const ShapeGroup &instance) {
    if (!is_invertible(instance.to_world))
        throw SceneError(instance.location, "the to_world of this instance cannot be undone: it is singular, or too "
                                            "nearly so, and would leave its shapes flat");
    KnownGroup &group = known_group(*instance.instanced);
    const Matrix4 to_world = multiply(instance.to_world, translation(group.origin));
    ++group.instances;
    const bool can_be_kept = group.bytes > 0 && instance_choice_ != InstanceChoice::copies && can_be_instance(to_world);
    const bool is_copied =
        !can_be_kept || (instance_choice_ == InstanceChoice::automatic &&
                         (group.instances == 1 || copied_bytes_ + group.bytes <= most_copied_bytes_));
    Copied copied{&group, make_instance(0, to_world), {}};
    for (const Prototype &prototype : group.prototypes) {
        if (prototype.can_be_kept && !is_copied)
            continue;
        const std::size_t before = scene_.shapes.size();
        copy_prototype(element, prototype, to_world);
        if (prototype.can_be_kept && scene_.shapes.size() > before)
            copied.shapes.push_back(before);
    }
    if (!is_copied) {
        count_geometry(kept_instance_bytes, element.location);
        add_group(group);
        if (group.number != no_group)
            scene_.instances.push_back(make_instance(std::uint32_t(group.number), to_world));
        return;
    }
    ++scene_.copied_instances;
    if (can_be_kept) {
        copied_bytes_ += group.instances == 1 ? 0 : group.bytes;
        copied_.push_back(std::move(copied));
    }
}

/// Shapes that instances share come into the scene, once.
void SceneBuilder::add_group(KnownGroup &group) {
    if (group.number != no_group)
        return;
    const std::size_t before = scene_.shapes.size();
    const auto number = std::int32_t(scene_.groups);
    for (const Prototype &prototype : group.prototypes)
        if (prototype.can_be_kept)
            add_shape(*prototype.element, prototype.geometry, number);
    if (scene_.shapes.size() == before)
        return;
    group.number = number;
    ++scene_.groups;
}

/// Where instances are kept, copies of groups that are seen more than once become instances too.
void SceneBuilder::settle_instances() {
    if (scene_.instances.empty())
        return;
    std::vector<char> goes(scene_.shapes.size(), 0);
    for (const Copied &copied : copied_) {
        KnownGroup &group = *copied.group;
        if (group.instances == 1)
            continue;
        add_group(group);
        for (const std::size_t shape : copied.shapes)
            goes[shape] = 1;
        --scene_.copied_instances;
        if (group.number == no_group)
            continue;
        scene_.instances.push_back(copied.instance);
        scene_.instances.back().group = std::uint32_t(group.number);
    }
    goes.resize(scene_.shapes.size(), 0); // groups came
    std::vector<char> mesh_goes(scene_.meshes.size(), 0);
    for (std::size_t i = 0; i < goes.size(); ++i)
        if (goes[i])
            mesh_goes[scene_.shapes[i].geometry] = 1;
    std::vector<std::uint32_t> place(scene_.meshes.size());
    std::size_t meshes = 0, shapes = 0;
    for (std::size_t i = 0; i < scene_.meshes.size(); ++i) {
        if (mesh_goes[i])
            continue;
        place[i] = std::uint32_t(meshes);
        if (meshes != i)
            scene_.meshes[meshes] = std::move(scene_.meshes[i]);
        ++meshes;
    }
    scene_.meshes.resize(meshes);
    for (std::size_t i = 0; i < goes.size(); ++i) {
        if (goes[i])
            continue;
        if (scene_.shapes[i].kind == Shape::Kind::mesh)
            scene_.shapes[i].geometry = place[scene_.shapes[i].geometry];
        if (shapes != i)
            scene_.shapes[shapes] = std::move(scene_.shapes[i]);
        ++shapes;
    }
    scene_.shapes.resize(shapes);
    copied_.clear();
}

} // namespace gradus
