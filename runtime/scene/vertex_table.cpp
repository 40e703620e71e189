#include "runtime/scene/vertex_table.h"

#include "runtime/error.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/parallel.h"
#include "runtime/scene/scene_tables.h"

#include <algorithm>
#include <cstring>
#include <limits>

// After all others: its short macro names are not for library headers.
#include "kernels/lib/instance.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/texture.h"

namespace gradus {

using namespace lib_float;

namespace {

bool has_uv(const TraitMap &traits) {
    return traits.at("TRAIT_MATERIAL") != 0 || traits.at("TRAIT_TEXTURED_LIGHTS") != 0 ||
           traits.at("TRAIT_ANISOTROPIC") != 0;
}

struct VertexPlaces {
    std::size_t numbers;
    bool has_normals, has_uv;

    void put(const Mesh &mesh, std::size_t vertex, const std::array<float, 2> &uv, float *record) const {
        const Vector3 &p = mesh.positions[vertex];
        record[0] = p.x, record[1] = p.y, record[2] = p.z;
        if (has_normals) {
            const Vector3 n = mesh.normals.empty() ? Vector3{} : mesh.normals[vertex];
            record[3] = n.x, record[4] = n.y, record[5] = n.z;
        }
        if (has_uv)
            std::copy(uv.begin(), uv.end(), record + numbers - 2);
    }
};

struct MeshCount {
    std::uint64_t triangles = 0, vertices = 0; // as the table has them
};

MeshCount count_meshes(const Scene &scene) {
    MeshCount count;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh) {
            count.triangles += scene.meshes[shape.geometry].triangles.size();
            count.vertices += table_vertex_count(scene, shape);
        }
    return count;
}

} // namespace

int indexed_trait(const TraitMap &traits, std::size_t triangles) {
    if (triangles <= most_dense_triangles && traits.at("TRAIT_INSTANCES") == 0)
        return 0;
    return 3 + (traits.at("TRAIT_SHADING_NORMALS") ? 3 : 0) + (has_uv(traits) ? 2 : 0);
}

const std::array<std::array<float, 2>, 3> unit_texcoords = {{{unit_first_u, 0}, {1, 0}, {0, 1}}};

bool has_own_vertices(const Scene &scene, const Shape &shape) {
    bool is_textured = false;
    for_each_texture(scene, shape, [&](std::int32_t texture) {
        is_textured |= scene.textures[std::size_t(texture)].kind != Texture::Kind::mesh_attribute;
    });
    return is_textured && scene.meshes[shape.geometry].texcoords.empty();
}

std::size_t table_vertex_count(const Scene &scene, const Shape &shape) {
    const Mesh &mesh = scene.meshes[shape.geometry];
    return has_own_vertices(scene, shape) ? 3 * mesh.triangles.size() : mesh.positions.size();
}

std::uint64_t geometry_table_bytes(const Scene &scene, const TraitMap &traits) {
    const auto [triangles, vertices] = count_meshes(scene);
    const std::uint64_t primitives = triangles + scene.spheres.size();
    const std::uint64_t of_spheres = scene.spheres.size() * (sphere_stride + (has_uv(traits) ? sphere_axes_stride : 0));
    if (const auto numbers = std::uint64_t(traits.at("TRAIT_INDEXED")))
        return 4 * (of_spheres + 3 * triangles + vertices * numbers + primitives +
                    scene.instances.size() * std::uint64_t(instance_stride));
    const bool has_textures = traits.at("TRAIT_MATERIAL") || traits.at("TRAIT_TEXTURED_LIGHTS");
    const std::uint64_t a_triangle = triangle_stride + (traits.at("TRAIT_SHADING_NORMALS") ? normals_stride : 0) +
                                     (traits.at("TRAIT_ANISOTROPIC") ? triangle_tangent_stride : 0) +
                                     (has_textures ? texcoords_stride : 0);
    return 4 * (of_spheres + a_triangle * triangles + 4 * primitives);
}

void add_vertices(const Scene &scene, int numbers, SceneTables &tables) {
    const VertexPlaces places{std::size_t(numbers), numbers >= 6, numbers == 5 || numbers == 8};
    auto [triangles, vertices] = count_meshes(scene);
    const bool is_empty = triangles == 0; // kernels may read one, whatever they then take
    triangles += is_empty;
    vertices += is_empty;
    const std::size_t first = (3 * triangles + places.numbers - 1) / places.numbers;
    // One number more, for the tracer reads four numbers of a position.
    std::size_t end = (first + vertices) * places.numbers + 1;
    const std::size_t first_instance = (end + instance_stride - 1) / instance_stride;
    if (!scene.instances.empty())
        end = (first_instance + 1 + scene.instances.size()) * instance_stride;
    if (end > std::size_t(std::numeric_limits<std::int32_t>::max()))
        throw Error(ExitCode::device, "the scene has more triangles, vertices and instances than kernels can address");
    tables.vertex_numbers = std::uint32_t(numbers);
    tables.first_vertex = std::uint32_t(first);
    tables.end_vertex = std::uint32_t(first + vertices);
    tables.triangles.resize(end);
    if (!scene.instances.empty()) {
        tables.no_instance = std::uint32_t(first_instance);
        put_instances(scene, &tables.triangles[first_instance * instance_stride]);
    }
    float *corners = tables.triangles.data();
    std::size_t vertex = first;
    if (is_empty)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const auto index = std::uint32_t(first);
            std::memcpy(corners + corner, &index, sizeof index);
        }
    for (const Shape &shape : scene.shapes) {
        if (shape.kind != Shape::Kind::mesh)
            continue;
        const Mesh &mesh = scene.meshes[shape.geometry];
        const bool own = has_own_vertices(scene, shape);
        for_each_in_parallel(mesh.triangles.size(), [&](std::size_t i) {
            std::array<std::uint32_t, 3> t;
            for (std::size_t corner = 0; corner < 3; ++corner)
                t[corner] = std::uint32_t(vertex + (own ? 3 * i + corner : mesh.triangles[i][corner]));
            std::memcpy(corners + 3 * i, t.data(), sizeof t);
        });
        const std::size_t count = table_vertex_count(scene, shape);
        for_each_in_parallel(count, [&](std::size_t i) {
            float *record = &tables.triangles[(vertex + i) * places.numbers];
            if (own)
                places.put(mesh, mesh.triangles[i / 3][i % 3], unit_texcoords[i % 3], record);
            else
                places.put(mesh, i, mesh.texcoords.empty() ? unit_texcoords[0] : mesh.texcoords[i], record);
        });
        corners += 3 * mesh.triangles.size();
        vertex += count;
    }
}

std::uint32_t SurfaceTable::number_of(const Surface &surface) {
    const auto [known, is_new] = known_.emplace(surface, std::uint32_t(surfaces_.size()));
    if (is_new)
        surfaces_.push_back(surface);
    return known->second;
}

void SurfaceTable::add(std::uint32_t material, std::uint32_t bin, std::uint32_t back_bin, std::uint32_t light) {
    // Lights have the numbers of their primitives less those that do not emit.
    const std::uint32_t lag = light == no_light ? no_light : std::uint32_t(of_primitive_.size()) - light;
    of_primitive_.push_back(number_of({material, bin, back_bin, lag}));
}

void SurfaceTable::add_unlit(std::uint32_t material, std::uint32_t bin, std::uint32_t back_bin, std::size_t count) {
    of_primitive_.insert(of_primitive_.end(), count, number_of({material, bin, back_bin, no_light}));
}

std::vector<std::uint32_t> SurfaceTable::finish() {
    std::vector<std::uint32_t> table = std::move(of_primitive_);
    const auto first = std::uint32_t(table.size());
    for (std::uint32_t &number : table)
        number = first + number * std::uint32_t(surface_of_stride);
    for (const Surface &surface : surfaces_)
        table.insert(table.end(), surface.begin(), surface.end());
    return table;
}

TableTriangle SceneTables::triangle(std::uint32_t number) const {
    TableTriangle found{};
    if (!is_indexed()) {
        const float *record = &triangles[std::size_t(number) * triangle_stride];
        std::copy_n(record + triangle_p0_x, 3, found.p0.begin());
        std::copy_n(record + triangle_e1_x, 3, found.e1.begin());
        std::copy_n(record + triangle_e2_x, 3, found.e2.begin());
        return found;
    }
    std::memcpy(found.corners.data(), &triangles[std::size_t(number) * 3], sizeof found.corners);
    const auto vertex = [&](std::size_t corner) {
        return &triangles[std::size_t(found.corners[corner]) * vertex_numbers];
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        found.p0[axis] = vertex(0)[axis];
        found.e1[axis] = vertex(1)[axis] - vertex(0)[axis];
        found.e2[axis] = vertex(2)[axis] - vertex(0)[axis];
    }
    return found;
}

TableTriangle SceneTables::triangle(std::uint32_t number, std::uint32_t instance) const {
    TableTriangle found = triangle(number);
    if (no_instance == 0)
        return found;
    constexpr std::uint32_t unit = 1;
    const instance_map map = instance_map_of(triangles.data(), unit, instance);
    const auto place = [](std::array<float, 3> &v, auto placed) {
        const vec3 to = placed(v3(v[0], v[1], v[2]));
        v = {to.x, to.y, to.z};
    };
    place(found.p0, [&](vec3 p) { return placed_point(map, p); });
    place(found.e1, [&](vec3 v) { return placed_vector(map, v); });
    place(found.e2, [&](vec3 v) { return placed_vector(map, v); });
    return found;
}

std::array<float, 6> SceneTables::texcoords(std::uint32_t number) const {
    std::array<float, 6> uv{};
    const TableTriangle of = triangle(number);
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const float *from = is_indexed() ? &triangles[std::size_t(of.corners[corner] + 1) * vertex_numbers - 2]
                                         : &triangle_texcoords[std::size_t(number) * texcoords_stride + 2 * corner];
        std::copy_n(from, 2, uv.begin() + std::ptrdiff_t(2 * corner));
    }
    return uv;
}

std::uint32_t SceneTables::light_of(std::uint32_t primitive) const {
    if (!is_indexed())
        return primitive_light[primitive];
    const std::uint32_t lag = primitive_surface[primitive_surface[primitive] + surface_of_lag];
    return lag == no_light ? no_light : primitive - lag;
}

} // namespace gradus
