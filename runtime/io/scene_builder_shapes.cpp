// Shapes of a scene file. Plugins say what is to be read, one after the other; then all cores read it; then shapes come
// into the scene, and what is said of them into the diagnostics, in the file's order.
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/scene_builder.h"
#include "runtime/phases.h"
#include "runtime/scene/bounds.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/own_origin.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

namespace gradus {

namespace {
constexpr std::size_t longest_line = 256;
/// Of mesh files in a line: what is read at once lies in memory beside what is built.
constexpr std::uint64_t most_line_bytes = 256u << 20;
/// Of mesh files, for further shapes of them.
constexpr std::uint64_t most_kept_bytes = 64u << 20;
constexpr std::size_t most_kept_files = 16;

/// A surface that all light passes as if it were not there.
bool is_never_met(const Material &material) {
    return material.opacity == 0.0f || (material.front.kind == BsdfKind::null && !material.two_sided);
}
} // namespace

/// A shape between its plugin and the scene.
struct SceneBuilder::ShapeInLine {
    const Element *element = nullptr;
    ShapeGeometry geometry = ShapeGroup();
    Double3 origin{0, 0, 0}; ///< of a group's shape, in its frame: what its geometry, once built, is relative to
    std::optional<SceneError> error;
    std::vector<Diagnostics::Held> messages; ///< of its plugin
    std::uint64_t unfolded_bytes = 0;
};

const std::string &MeshFile::bytes() {
    const std::lock_guard lock(mutex_);
    if (!bytes_)
        if (const auto file = finder_.open(path_); file && file->bytes() <= size_) {
            bytes_ = file->read();
            place_ = file->place();
        }
    if (!bytes_)
        throw SceneError(location_, "cannot read " + path_.string());
    return *bytes_;
}

const ObjFile &MeshFile::obj() {
    const std::string &text = bytes();
    const std::lock_guard lock(obj_mutex_);
    if (!obj_) {
        try {
            obj_ = ObjFile(text, path_.string(), place_);
        } catch (const SceneError &error) {
            obj_ = error;
        }
    }
    if (const auto *error = std::get_if<SceneError>(&*obj_))
        throw *error;
    return std::get<ObjFile>(*obj_);
}

std::shared_ptr<MeshFile> SceneBuilder::mesh_file(const std::filesystem::path &path, const Location &location) {
    const std::uint64_t size = open_file(path, location)->bytes();
    count_mesh_bytes(size, location);
    return std::make_shared<MeshFile>(finder_, path, size, location);
}

std::shared_ptr<MeshFile> SceneBuilder::shared_mesh_file(const std::filesystem::path &path, const Location &location) {
    const auto known = std::ranges::find(shared_files_, path, &MeshFile::path);
    if (known == shared_files_.end())
        shared_files_.push_back(mesh_file(path, location));
    else
        std::rotate(known, known + 1, shared_files_.end());
    std::uint64_t bytes = 0;
    for (const std::shared_ptr<MeshFile> &file : shared_files_)
        bytes += file->size();
    while (shared_files_.size() > 1 && (bytes > most_kept_bytes || shared_files_.size() > most_kept_files)) {
        bytes -= shared_files_.front()->size();
        shared_files_.erase(shared_files_.begin());
    }
    return shared_files_.back();
}

void SceneBuilder::count_mesh_bytes(std::uint64_t bytes, const Location &location) {
    mesh_bytes_ += std::min(bytes, limits_.mesh_bytes + 1);
    if (mesh_bytes_ > limits_.mesh_bytes)
        throw SceneError(location,
                         "the shapes up to this one read more than " + std::to_string(limits_.mesh_bytes >> 20) +
                             " MiB of meshes" + limits_hint,
                         "mesh bytes");
}

void SceneBuilder::count_geometry(std::uint64_t bytes, const Location &location) {
    geometry_bytes_ += bytes;
    if (geometry_bytes_ > limits_.geometry_bytes)
        throw SceneError(location,
                         "the meshes up to this one have more than " + std::to_string(limits_.geometry_bytes >> 20) +
                             " MiB of vertices and triangles" + limits_hint,
                         "geometry bytes");
}

/// Where media are not to be ignored, an error at each, else a warning.
void SceneBuilder::check_media(const Element &element) {
    for (const char *tag : {"medium", "subsurface", "volume", "phase"})
        for (const NestedObject &found : nested_objects(element, tag, resolve_)) {
            if (!told_media_.insert(found.element).second)
                continue;
            const std::string what = described(*found.element);
            if (ignore_media_)
                diagnostics_.warn(found.location, what + " is left out (--ignore-media)");
            else
                diagnostics_.error(found.location, what + ": participating media are not supported; --ignore-media "
                                                          "renders the scene without them");
        }
}

/// Runs the plugin of a shape, or of the shapes in it. `parents`: those that it is in.
void SceneBuilder::put_in_line(const Element &element, bool in_group, std::vector<const Element *> &parents,
                               std::deque<ShapeInLine> &line) {
    ShapeInLine &shape = line.emplace_back();
    shape.element = &element;
    diagnostics_.hold();
    try {
        if (++shapes_in_line_ > limits_.elements)
            throw SceneError(element.location, "more than " + std::to_string(limits_.elements) +
                                                   " shapes, as often as shapes contain them" + limits_hint);
        if (std::find(parents.begin(), parents.end(), &element) != parents.end())
            throw SceneError(element.location, "a shape contains itself through a <ref>");
        if (in_group && type_of(element) == "shapegroup")
            throw SceneError(element.location, "a shapegroup in a shapegroup is not supported");
        check_media(element);
        shape.geometry = build_object<ShapeGeometry>(element);
        if (const auto *group = std::get_if<ShapeGroup>(&shape.geometry); group && group->instanced && in_group)
            throw SceneError(element.location, "an instance in a shapegroup is not supported, nor is it by Mitsuba");
    } catch (const SceneError &error) {
        shape.error = error;
    }
    shape.messages = diagnostics_.release();
    const auto *group = std::get_if<ShapeGroup>(&shape.geometry);
    if (shape.error || !group || group->instanced)
        return;
    const std::vector<const Element *> inside = group->shapes; // `line` grows
    parents.push_back(&element);
    for (const Element *child : inside)
        put_in_line(*child, in_group, parents, line);
    parents.pop_back();
}

/// Into the scene, or into `group` where that is given.
void SceneBuilder::build_shapes(const std::vector<const Element *> &elements, std::vector<Prototype> *group) {
    std::deque<ShapeInLine> line;
    std::uint64_t bytes = mesh_bytes_;
    for (const Element *element : elements) {
        std::vector<const Element *> parents;
        put_in_line(*element, group != nullptr, parents, line);
        if (line.size() >= longest_line || mesh_bytes_ - bytes > most_line_bytes) {
            build_line(line, group);
            bytes = mesh_bytes_;
        }
    }
    build_line(line, group);
}

void SceneBuilder::build_line(std::deque<ShapeInLine> &line, std::vector<Prototype> *group) {
    const Phase phase(phases_, phase_names::meshes);
    const auto read_file = [](const ShapeInLine &shape) {
        try {
            return std::get<PendingMesh>(shape.geometry).read();
        } catch (const SceneError &error) {
            throw error.named_at(shape.element->location);
        }
    };
    const auto read = [&](ShapeInLine &shape) {
        auto &pending = std::get<PendingMesh>(shape.geometry);
        try {
            SerializedMesh mesh = read_file(shape);
            shape.unfolded_bytes = mesh.unfolded_bytes;
            pending.options.face_normals |= mesh.face_normals;
            if (group)
                shape.origin = own_origin_of(placed_bounds(bounds_of(mesh.mesh), pending.to_world));
            const Matrix4 to_origin = multiply(translation(scale(shape.origin, -1)), pending.to_world);
            shape.geometry = build_mesh(std::move(mesh.mesh), to_origin, pending.options);
        } catch (const SceneError &error) {
            shape.error = error;
        }
    };
    // What is past the limit is left for one after the other, where the first that is too much is told.
    std::atomic<std::uint64_t> unfolded = mesh_bytes_;
    const auto is_too_much = [&] { return geometry_bytes_ > limits_.geometry_bytes; };
    tbb::parallel_for(std::size_t(0), line.size(), [&](std::size_t i) {
        if (std::holds_alternative<PendingMesh>(line[i].geometry) && unfolded <= limits_.mesh_bytes && !is_too_much()) {
            read(line[i]);
            unfolded += line[i].unfolded_bytes;
        }
    });
    for (ShapeInLine &shape : line) {
        if (!shape.error && std::holds_alternative<PendingMesh>(shape.geometry) && !is_too_much())
            read(shape);
        diagnostics_.replay(shape.messages);
        try {
            if (shape.error)
                throw *shape.error;
            count_geometry(0, shape.element->location); // nothing was read where it is too much already
            count_mesh_bytes(shape.unfolded_bytes, shape.element->location);
            finish(shape, group);
        } catch (const SceneError &error) {
            diagnostics_.error(error);
            check_parts(*shape.element);
        }
        shape.geometry = ShapeGroup();
    }
    line.clear();
}

/// Of a shape that is not built, what else is wrong with it.
void SceneBuilder::check_parts(const Element &shape) {
    tell_errors([&] { material_of(shape); });
    tell_errors([&] { emitter_of(shape); });
}

void SceneBuilder::finish(ShapeInLine &shape, std::vector<Prototype> *group) {
    if (const auto *inside = std::get_if<ShapeGroup>(&shape.geometry)) {
        if (inside->instanced)
            add_instance(*shape.element, *inside);
        return;
    }
    std::variant<BuiltMesh, Sphere> geometry = Sphere();
    if (auto *built = std::get_if<BuiltMesh>(&shape.geometry))
        geometry = std::move(*built);
    else {
        auto [sphere, center] = std::get<PlacedSphere>(shape.geometry);
        if (group) {
            shape.origin = center;
            sphere.center = {0, 0, 0};
        }
        geometry = sphere;
    }
    if (group)
        group->push_back({shape.element, std::move(geometry), shape.origin});
    else
        add_shape(*shape.element, std::move(geometry));
}

namespace {
/// Whether a mesh is so narrow that its coordinates' rounding is a percent of that.
bool is_rounded_away(const Mesh &mesh) {
    constexpr double least = 1e-5;
    const Bounds bounds = bounds_of(mesh);
    double farthest = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
    return std::min(bounds.extent(), surface_area(mesh) / bounds.extent()) < least * farthest;
}
} // namespace

void SceneBuilder::add_shape(const Element &element, std::variant<BuiltMesh, Sphere> geometry, std::int32_t group) {
    Shape shape;
    shape.group = group;
    shape.name = element.attribute_or("id", element.attribute_or("type", "") + " at " + element.location.text());
    if (auto *built = std::get_if<BuiltMesh>(&geometry)) {
        settle_attributes(built->mesh, shape.name, element.location);
        if (built->degenerate > 0)
            diagnostics_.warn(element.location, std::to_string(built->degenerate) +
                                                    " degenerate triangles of shape \"" + shape.name +
                                                    "\" are left out");
        count_geometry(mesh_bytes(built->mesh), element.location);
        if (built->mesh.triangles.empty()) {
            diagnostics_.warn(element.location, "shape \"" + shape.name + "\" has no area and is left out");
            return;
        }
    }
    // In 0.x a boundary of media without a BSDF is not seen itself.
    const bool is_boundary = element.is_legacy() && !nested_objects(element, "medium", resolve_).empty();
    shape.material =
        is_boundary && nested_objects(element, "bsdf", resolve_).empty() ? boundary_material() : material_of(element);
    shape.emitter = emitter_of(element);
    shape.is_black_lamp = shape.emitter < 0 && !nested_objects(element, "emitter", resolve_).empty();
    const Material &material = scene_.materials[shape.material];
    if (shape.emitter < 0 && is_never_met(material))
        return;
    const auto *with_mesh = std::get_if<BuiltMesh>(&geometry);
    check_attributes(shape, with_mesh ? &with_mesh->mesh : nullptr, element.location);
    if (shape.emitter >= 0 && material.opacity < 1)
        diagnostics_.warn(element.location, "shape \"" + shape.name + "\" emits: its opacity is taken as 1");
    if (shape.emitter >= 0 && with_mesh && is_rounded_away(with_mesh->mesh))
        diagnostics_.warn(element.location, "shape \"" + shape.name +
                                                "\" emits and is so narrow, as far from the origin as it is, that "
                                                "its area is off by a percent or more in single precision, and its "
                                                "light with it: move the scene to the origin, or take a sphere");
    if (const auto *sphere = std::get_if<Sphere>(&geometry)) {
        shape.kind = Shape::Kind::sphere;
        shape.geometry = std::uint32_t(scene_.spheres.size());
        scene_.spheres.push_back(*sphere);
        if (shape.emitter < 0 && (material.opacity.texture != no_texture || material.opacity < 1)) {
            scene_.spheres.back().side = Sphere::Side::entered;
            scene_.shapes.push_back(shape);
            shape.geometry = std::uint32_t(scene_.spheres.size());
            scene_.spheres.push_back(*sphere);
            scene_.spheres.back().side = Sphere::Side::left;
        }
    } else {
        shape.kind = Shape::Kind::mesh;
        shape.geometry = std::uint32_t(scene_.meshes.size());
        scene_.meshes.push_back(std::move(std::get<BuiltMesh>(geometry).mesh));
    }
    scene_.shapes.push_back(std::move(shape));
}

} // namespace gradus
