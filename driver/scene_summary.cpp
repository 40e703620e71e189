#include "driver/scene_summary.h"

#include "runtime/scene/environment_map.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/texture.h"
#include "runtime/scene/traits.h"
#include "runtime/scene/vertex_table.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

namespace gradus {
namespace {

/// What Embree 3.13 keeps of a triangle at high build quality, its copy of vertices and indices included: its memory
/// monitor says 79 to 82 bytes on grids of ten thousand to a million triangles, 100 on one of 200. Of those that are
/// laid out by index it shares vertices and indices.
constexpr std::uint64_t tree_bytes_per_triangle = 82, shared_tree_bytes_per_triangle = 64;

/// What a process grows by as Embree takes an instance (tests/trace/instances_test.cpp).
constexpr std::uint64_t tree_bytes_per_instance = 380;

std::string side_name(const Bsdf &bsdf) { return bsdf.blend == no_blend ? bsdf_kind_name(bsdf) : "blendbsdf"; }

std::string material_name(const Material &material) {
    const bool is_open = material.opacity.texture != no_texture || material.opacity < 1;
    const std::string front = (is_open ? "mask " : "") + side_name(material.front);
    if (!material.two_sided)
        return front;
    const std::string back = side_name(material.back);
    return side_name(material.front) == back ? "twosided " + front : "twosided " + front + "/" + back;
}

/// Of textures and the environment.
std::uint64_t picture_bytes(const Scene &scene) {
    std::uint64_t bytes = 0;
    std::set<const Bitmap *> pictures;
    for (const Texture &texture : scene.textures)
        if (texture.bitmap && pictures.insert(texture.bitmap.get()).second)
            bytes += 4 * std::uint64_t(texture.bitmap->words.size());
    for (const Emitter &emitter : scene.emitters)
        if (emitter.map)
            bytes += environment_bytes(*emitter.map);
    return bytes;
}

} // namespace

const char *name_of(Emitter::Kind kind) {
    switch (kind) {
    case Emitter::Kind::area:
        return "area";
    case Emitter::Kind::constant:
        return "constant";
    case Emitter::Kind::point:
        return "point";
    case Emitter::Kind::directional:
        return "directional";
    case Emitter::Kind::environment:
        return "envmap";
    case Emitter::Kind::spot:
        return "spot";
    case Emitter::Kind::projector:
        return "projector";
    }
    return "unknown";
}

const char *name_of(Texture::Kind kind) {
    switch (kind) {
    case Texture::Kind::bitmap:
        return "bitmap";
    case Texture::Kind::checkerboard:
        return "checkerboard";
    case Texture::Kind::mesh_attribute:
        return "mesh_attribute";
    }
    return "unknown";
}

const char *name_of(FilmSettings::Filter filter) {
    switch (filter) {
    case FilmSettings::Filter::box:
        return "box";
    case FilmSettings::Filter::tent:
        return "tent";
    case FilmSettings::Filter::gaussian:
        return "gaussian";
    case FilmSettings::Filter::mitchell:
        return "mitchell";
    case FilmSettings::Filter::catmullrom:
        return "catmullrom";
    case FilmSettings::Filter::lanczos:
        return "lanczos";
    }
    return "unknown";
}

const char *name_of(Camera::Kind kind) {
    switch (kind) {
    case Camera::Kind::perspective:
        return "perspective";
    case Camera::Kind::thin_lens:
        return "thinlens";
    case Camera::Kind::orthographic:
        return "orthographic";
    }
    return "unknown";
}

const char *name_of(Camera::FovAxis axis) {
    switch (axis) {
    case Camera::FovAxis::x:
        return "x";
    case Camera::FovAxis::y:
        return "y";
    case Camera::FovAxis::smaller:
        return "smaller";
    case Camera::FovAxis::larger:
        return "larger";
    case Camera::FovAxis::diagonal:
        return "diagonal";
    }
    return "unknown";
}

SceneSummary summarize(const Scene &scene) {
    SceneSummary summary;
    std::vector<std::uint64_t> triangles_of_group(scene.groups);
    for (const Shape &shape : scene.shapes) {
        if (shape.group != no_group)
            triangles_of_group[std::size_t(shape.group)] += scene.meshes[shape.geometry].triangles.size();
        if (shape.kind == Shape::Kind::mesh)
            ++summary.meshes;
        else if (scene.spheres[shape.geometry].side != Sphere::Side::left) // the same one once more
            ++summary.spheres;
    }
    const Bounds bounds = world_bounds(scene);
    for (const Mesh &mesh : scene.meshes) {
        summary.triangles += mesh.triangles.size();
        summary.vertices += mesh.positions.size();
        summary.geometry_bytes += mesh_bytes(mesh);
    }
    summary.group_triangles = std::accumulate(triangles_of_group.begin(), triangles_of_group.end(), std::uint64_t(0));
    summary.seen_triangles = summary.triangles - summary.group_triangles;
    for (const Instance &instance : scene.instances)
        summary.seen_triangles += triangles_of_group[instance.group];
    summary.instance_bytes = scene.instances.size() * (sizeof(Instance) + tree_bytes_per_instance);
    const TraitMap traits = scene_traits(scene);
    summary.table_bytes = geometry_table_bytes(scene, traits);
    summary.tree_bytes =
        summary.triangles * (traits.at("TRAIT_INDEXED") ? shared_tree_bytes_per_triangle : tree_bytes_per_triangle);
    if (!scene.shapes.empty()) {
        summary.lower = bounds.lower;
        summary.upper = bounds.upper;
    }
    for (const Material &material : scene.materials)
        ++summary.materials[material_name(material)];
    for (const Texture &texture : scene.textures)
        ++summary.textures[name_of(texture.kind)];
    summary.texture_bytes = picture_bytes(scene);
    for (const Emitter &emitter : scene.emitters)
        ++summary.emitters[name_of(emitter.kind)];
    return summary;
}

} // namespace gradus
