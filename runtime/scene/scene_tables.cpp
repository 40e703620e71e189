#include "runtime/scene/scene_tables.h"

#include "kernels/lib/scene_triangle.h"
#include "kernels/shared/material.h"
#include "kernels/shared/scene_records.h"
#include "kernels/shared/texture.h"
#include "runtime/scene/attribute_light.h"
#include "runtime/scene/camera_record.h"
#include "runtime/scene/coating.h"
#include "runtime/scene/environment_map.h"
#include "runtime/scene/instances.h"
#include "runtime/scene/light_builder.h"
#include "runtime/scene/lights_in_surfaces.h"
#include "runtime/scene/texture_tables.h"
#include "runtime/scene/vertex_table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace gradus {

using namespace lib_float;

namespace {

constexpr double pi = std::numbers::pi;
constexpr double tracer_error = GRADUS_TRACER_ERROR, least_slant = GRADUS_LEAST_SLANT, most_slant = GRADUS_MOST_SLANT;

Vector3 operator-(Vector3 a, Vector3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector3 operator*(float s, Vector3 a) { return {s * a.x, s * a.y, s * a.z}; }
Vector3 cross(Vector3 a, Vector3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Vector3 a) { return std::sqrt(double(a.x) * a.x + double(a.y) * a.y + double(a.z) * a.z); }

/// What a triangle adds to how far rays start off it.
float triangle_offset_of(Vector3 e1, Vector3 e2, double area) {
    const double slant = area > 0 ? length(e1) * length(e2) / (2 * area) : most_slant;
    const double longest = std::max({length(e1), length(e2), length(e2 - e1)});
    return static_cast<float>(tracer_error * longest * std::clamp(slant / least_slant, 1.0, most_slant / least_slant));
}

void put(float *record, int field, Vector3 v) {
    record[field] = v.x;
    record[field + 1] = v.y;
    record[field + 2] = v.z;
}

/// The bin of a side of a surface that does not emit; that of one that does follows. Blends are behind all kinds.
std::uint32_t bin_of(const Bsdf &bsdf, std::uint32_t number_of_class, const SceneTables &tables) {
    const bool is_blend = bsdf.blend != no_blend;
    return 1 + 2 * (is_blend ? std::uint32_t(tables.kinds.size())
                             : tables.place_of_kind(bsdf_kind_name(bsdf), number_of_class));
}

/// What all primitives of a shape share.
struct SurfaceOfShape {
    std::uint32_t material, bin, back_bin;

    SurfaceOfShape(const Scene &scene, const Shape &shape, const SceneTables &tables, const MaterialClasses *classes) {
        const Material &of_shape = scene.materials[shape.material];
        material = shape.material | (of_shape.two_sided ? material_two_sided : 0);
        const std::uint32_t number = classes ? classes->of_kinds(shape.material) : 0;
        bin = bin_of(of_shape.front, number, tables);
        back_bin = bin_of(of_shape.two_sided ? of_shape.back : of_shape.front, number, tables);
    }
};

/// Puts one primitive after the other into the tables.
class PrimitiveBuilder {
  public:
    PrimitiveBuilder(SceneTables &tables, bool is_indexed) : tables_(tables), is_indexed_(is_indexed) {}
    bool is_indexed() const { return is_indexed_; }
    void reserve(std::size_t primitives) {
        if (is_indexed_)
            surfaces_.reserve(primitives);
        else
            for (std::vector<std::uint32_t> *column : {&tables_.primitive_light, &tables_.primitive_material,
                                                       &tables_.primitive_bin, &tables_.primitive_back_bin})
                column->reserve(primitives);
    }
    void add(const SurfaceOfShape &surface, std::uint32_t light) {
        const std::uint32_t emits = light == no_light ? 0 : 1;
        ++tables_.primitive_count;
        if (is_indexed_) {
            surfaces_.add(surface.material, surface.bin + emits, surface.back_bin + emits, light);
            return;
        }
        tables_.primitive_light.push_back(light);
        tables_.primitive_material.push_back(surface.material);
        tables_.primitive_bin.push_back(surface.bin + emits);
        tables_.primitive_back_bin.push_back(surface.back_bin + emits);
    }
    /// So many with indices that do not emit.
    void add_unlit(const SurfaceOfShape &surface, std::size_t count) {
        surfaces_.add_unlit(surface.material, surface.bin, surface.back_bin, count);
        tables_.primitive_count += std::uint32_t(count);
    }
    void finish() {
        if (is_indexed_)
            tables_.primitive_surface = surfaces_.finish();
    }

  private:
    SceneTables &tables_;
    const bool is_indexed_;
    SurfaceTable surfaces_;
};

/// What a mesh without indices has of each triangle.
void add_triangle(const Mesh &mesh, std::size_t number, const TraitMap &traits, SceneTables &tables) {
    const auto &t = mesh.triangles[number];
    const Vector3 p0 = mesh.positions[t[0]];
    const Vector3 e1 = mesh.positions[t[1]] - p0, e2 = mesh.positions[t[2]] - p0;
    const Vector3 area_normal = cross(e1, e2);
    const double area = 0.5 * length(area_normal);
    tables.triangles.resize(tables.triangles.size() + triangle_stride, 0.0f);
    float *record = &tables.triangles[tables.triangles.size() - triangle_stride];
    put(record, triangle_p0_x, p0);
    put(record, triangle_e1_x, e1);
    put(record, triangle_e2_x, e2);
    record[triangle_offset] = triangle_offset_of(e1, e2, area);

    if (traits.at("TRAIT_SHADING_NORMALS")) {
        const Vector3 flat = static_cast<float>(1 / (2 * area)) * area_normal;
        for (int corner = 0; corner < 3; ++corner) {
            const Vector3 n = mesh.normals.empty() ? flat : mesh.normals[t[corner]];
            tables.triangle_normals.insert(tables.triangle_normals.end(), {n.x, n.y, n.z});
        }
    }
    if (traits.at("TRAIT_MATERIAL") || traits.at("TRAIT_TEXTURED_LIGHTS"))
        add_triangle_texcoords(mesh, t, tables);
    if (traits.at("TRAIT_ANISOTROPIC")) {
        Vector3 along{};
        if (!mesh.texcoords.empty()) {
            const auto &a = mesh.texcoords[t[0]], &b = mesh.texcoords[t[1]], &c = mesh.texcoords[t[2]];
            const float u1 = b[0] - a[0], v1 = b[1] - a[1], u2 = c[0] - a[0], v2 = c[1] - a[1];
            const float determinant = u1 * v2 - u2 * v1;
            const float sign = determinant < 0 ? -1.0f : 1.0f; // only the direction counts
            along = determinant == 0 ? Vector3{} : sign * (v2 * e1 - v1 * e2);
        }
        tables.triangle_tangents.insert(tables.triangle_tangents.end(), {along.x, along.y, along.z});
    }
}

Rgb times(const Rgb &a, const Rgb &b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }

/// The texture of a light that a mesh bears, or nullptr.
const Texture *attribute_of(const Scene &scene, const Emitter &emitter) {
    if (emitter.texture == no_texture)
        return nullptr;
    const Texture &texture = scene.textures[std::size_t(emitter.texture)];
    return texture.kind == Texture::Kind::mesh_attribute ? &texture : nullptr;
}

/// Lights that the triangles of a shape are.
class TriangleLights {
  public:
    TriangleLights(const Scene &scene, const Shape &shape, LightBuilder &lights)
        : mesh_(scene.meshes[shape.geometry]), number_(shape.emitter), lights_(lights) {
        if (number_ < 0)
            return;
        emitter_ = &scene.emitters[std::size_t(number_)];
        bright_ = attribute_of(scene, *emitter_);
        if (bright_)
            mean_of_all_ = times(emitter_->value, mean_over_mesh(*bright_, mesh_));
    }

    /// The light that a triangle is, or no_light. `primitive`: its number among those of the scene.
    std::uint32_t add(std::size_t triangle, std::uint32_t primitive) {
        if (!emitter_)
            return no_light;
        const auto &t = mesh_.triangles[triangle];
        const Vector3 p0 = mesh_.positions[t[0]];
        const Vector3 e1 = mesh_.positions[t[1]] - p0, e2 = mesh_.positions[t[2]] - p0;
        const double area = 0.5 * length(cross(e1, e2));
        const Rgb mean = bright_ ? times(emitter_->value, mean_over_triangle(*bright_, mesh_, triangle))
                                 : lights_.mean_of(*emitter_);
        const double power = pi * area * luminance(mean);
        if (!(power > 0))
            return no_light;
        float *record;
        const std::uint32_t light =
            lights_.add(light_kind_triangle, emitter_->value, {power, std::uint32_t(number_), false}, record);
        put(record, light_p_x, p0);
        put(record, light_e1_x, e1);
        put(record, light_e2_x, e2);
        record[light_inverse_area] = static_cast<float>(std::min(1 / area, 3e38));
        record[light_offset] = triangle_offset_of(e1, e2, area);
        lights_.set_triangle(light, primitive);
        if (bright_)
            lights_.set_mean(light, mean_of_all_);
        return light;
    }

  private:
    const Mesh &mesh_;
    const std::int32_t number_;
    LightBuilder &lights_;
    const Emitter *emitter_ = nullptr;
    const Texture *bright_ = nullptr;
    Rgb mean_of_all_;
};

void add_mesh(const Scene &scene, const Shape &shape, const SurfaceOfShape &surface, const TraitMap &traits,
              SceneTables &tables, PrimitiveBuilder &primitives, LightBuilder &lights) {
    const Mesh &mesh = scene.meshes[shape.geometry];
    if (primitives.is_indexed() && shape.emitter < 0) {
        primitives.add_unlit(surface, mesh.triangles.size());
        return;
    }
    TriangleLights of_shape(scene, shape, lights);
    for (std::size_t number = 0; number < mesh.triangles.size(); ++number) {
        if (!primitives.is_indexed())
            add_triangle(mesh, number, traits, tables);
        primitives.add(surface, of_shape.add(number, tables.primitive_count));
    }
}

void add_sphere(const Scene &scene, const Shape &shape, const SurfaceOfShape &surface, SceneTables &tables,
                PrimitiveBuilder &primitives, LightBuilder &lights) {
    const Sphere &sphere = scene.spheres[shape.geometry];
    const float offset = static_cast<float>(tracer_error * sphere.radius);
    const float facing = sphere.flip_normals ? -1.0f : 1.0f;
    tables.spheres.resize(tables.spheres.size() + sphere_stride);
    float *record = &tables.spheres[tables.spheres.size() - sphere_stride];
    put(record, sphere_center_x, sphere.center);
    record[sphere_radius] = sphere.signed_radius();
    record[sphere_facing] = facing;
    record[sphere_offset] = offset;
    put(record, sphere_pole_x, sphere.axes[2]);

    std::uint32_t light = no_light;
    if (shape.emitter >= 0) {
        const Emitter &emitter = scene.emitters[shape.emitter];
        const Rgb radiance = emitter.value;
        const double area = 4 * pi * double(sphere.radius) * sphere.radius;
        const double power = pi * area * luminance(lights.mean_of(emitter));
        if (power > 0) {
            float *light_record;
            light = lights.add(light_kind_sphere, radiance, {power, std::uint32_t(shape.emitter), false}, light_record);
            put(light_record, light_p_x, sphere.center);
            light_record[light_e1_x] = sphere.radius;
            light_record[light_e1_y] = facing;
            light_record[light_inverse_area] = static_cast<float>(std::min(1 / area, 3e38));
            light_record[light_offset] = offset;
            lights.set_sphere(light, std::uint32_t(tables.spheres.size() / sphere_stride - 1));
        }
    }
    primitives.add(surface, light);
}

/// Lights without a surface. Those at infinity count with what crosses a disk as wide as the scene.
void add_other_lights(const Scene &scene, double radius, SceneTables &tables, LightBuilder &lights) {
    const double disk = pi * radius * radius;
    const std::vector<float> gaps = gaps_in_surfaces(scene);
    for (std::uint32_t number = 0; number < scene.emitters.size(); ++number) {
        const Emitter &emitter = scene.emitters[number];
        const double value = luminance(lights.mean_of(emitter));
        if (emitter.kind == Emitter::Kind::area || !(value > 0))
            continue;
        float *record;
        if (emitter.kind == Emitter::Kind::constant) {
            lights.add(light_kind_constant, emitter.value, {pi * value * disk, number, true}, record);
            lights.set_environment(4 * pi * value * disk); // from all directions
        } else if (emitter.kind == Emitter::Kind::environment) {
            // A plane of any direction gets a quarter of what comes from all of them, in the mean.
            const Rgb sent = emitter.map->integral;
            const double all =
                luminance({emitter.value.r * sent.r, emitter.value.g * sent.g, emitter.value.b * sent.b});
            if (!(all > 0))
                continue;
            const float unit = emitter.map->unit;
            const Rgb scaled{emitter.value.r * unit, emitter.value.g * unit, emitter.value.b * unit};
            lights.add(light_kind_environment, scaled, {all / 4 * disk, number, true}, record);
            lights.set_environment(all * disk);
            put(record, light_p_x, emitter.axes[0]);
            put(record, light_e1_x, emitter.axes[1]);
            put(record, light_e2_x, emitter.axes[2]);
            record[light_inverse_area] = emitter.map->scale;
            tables.environment = emitter.map;
        } else if (emitter.kind == Emitter::Kind::spot) {
            const double cutoff = emitter.cutoff, beam = emitter.beam, ramp = cutoff - beam;
            // 1 - (sin cutoff - sin beam) / ramp, which is 1 - cos cutoff without a ramp, but above 0 for any cutoff.
            const double middle = 0.5 * (cutoff + beam), half = 0.5 * ramp;
            const double within = 2 * std::pow(std::sin(0.5 * middle), 2);
            const double sent = within + (half > 0 ? std::cos(middle) * (1 - std::sin(half) / half) : 0);
            lights.add(light_kind_spot, emitter.value, {2 * pi * value * sent, number, false}, record);
            put(record, light_p_x, emitter.position);
            put(record, light_e1_x, emitter.direction);
            const double half_sine = std::sin(cutoff / 2);
            put(record, light_e2_x,
                {float(cutoff / (2 * pi)), float(std::min(ramp > 0 ? 2 * pi / ramp : 1e30, 1e30)),
                 float(2 * half_sine * half_sine)});
        } else if (emitter.kind == Emitter::Kind::projector) {
            const double area = double(emitter.picture[0]) * emitter.picture[1];
            lights.add(light_kind_projector, emitter.value, {value * area, number, false}, record);
            put(record, light_p_x, emitter.position);
            put(record, light_e1_x, emitter.direction);
        } else if (emitter.kind == Emitter::Kind::point) {
            lights.add(light_kind_point, emitter.value, {4 * pi * value, number, false}, record);
            put(record, light_p_x, emitter.position);
        } else {
            lights.add(light_kind_directional, emitter.value, {value * disk, number, true}, record);
            put(record, light_p_x, -1.0f * emitter.direction);
        }
        record[light_offset] = gaps[number];
    }
}

void add_material_record(const Bsdf &bsdf, SceneTables &tables) {
    tables.materials.resize(tables.materials.size() + material_stride);
    float *record = &tables.materials[tables.materials.size() - material_stride];
#define GRADUS_PUT_COLOR(with, name, value, text)                                                                      \
    put(record, material_##name##_r, {bsdf.name.r, bsdf.name.g, bsdf.name.b});
#define GRADUS_PUT_NUMBER(with, name, value, text) record[material_##name] = bsdf.name;
    GRADUS_MATERIAL_PARAMETERS(GRADUS_PUT_COLOR, GRADUS_PUT_NUMBER, )
#undef GRADUS_PUT_COLOR
#undef GRADUS_PUT_NUMBER
    // Where nothing is refracted, paths go straight on.
    const std::vector<std::string> &parameters = bsdf_kind_traits(bsdf.kind).parameters;
    if (bsdf_kind_traits(bsdf.kind).transmits &&
        std::find(parameters.begin(), parameters.end(), "ior") == parameters.end())
        record[material_ior] = 1;
    record[material_bsdf] = static_cast<float>(bsdf_kind_number(bsdf));
    tables.material_back.push_back(static_cast<std::uint32_t>(tables.material_back.size()));
}

/// Room for all that primitives have: tables that grow are copied again and again, and take twice their size.
void reserve_tables(const Scene &scene, const TraitMap &traits, SceneTables &tables, PrimitiveBuilder &primitives) {
    std::size_t triangles = 0;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh)
            triangles += scene.meshes[shape.geometry].triangles.size();
    primitives.reserve(triangles + scene.spheres.size());
    if (primitives.is_indexed())
        return;
    tables.triangles.reserve(triangles * triangle_stride);
    if (traits.at("TRAIT_SHADING_NORMALS"))
        tables.triangle_normals.reserve(triangles * normals_stride);
    if (traits.at("TRAIT_ANISOTROPIC"))
        tables.triangle_tangents.reserve(triangles * triangle_tangent_stride);
}

bool has_own_back(const Material &material) { return material.two_sided && !(material.back == material.front); }

/// After all others the records that coats of varying roughness have, once for each kind and index.
void add_coat_records(const std::vector<Bsdf> &records, SceneTables &tables) {
    std::map<std::pair<BsdfKind, float>, std::size_t> first;
    for (std::size_t i = 0; i < records.size(); ++i) {
        if (!has_varying_coat(records[i]))
            continue;
        const std::size_t count = tables.materials.size() / material_stride;
        const auto [found, is_new] = first.emplace(std::pair(records[i].kind, float(records[i].ior)), count);
        if (is_new)
            for (const Bsdf &bsdf : coat_records(records[i]))
                add_material_record(bsdf, tables);
        tables.materials[i * material_stride + material_coat_records] = float(found->second);
    }
}

void add_materials(const Scene &scene, SceneTables &tables) {
    const std::vector<Bsdf> records = material_records(scene);
    for (const Bsdf &bsdf : records)
        add_material_record(bsdf, tables);
    add_coat_records(records, tables);
    std::uint32_t back = static_cast<std::uint32_t>(scene.materials.size());
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        if (has_own_back(scene.materials[i]))
            tables.material_back[i] = back++;
}

} // namespace

std::vector<Bsdf> material_records(const Scene &scene) {
    std::vector<Bsdf> records;
    for (const Material &material : scene.materials)
        records.push_back(material.front);
    for (const Material &material : scene.materials)
        if (has_own_back(material))
            records.push_back(material.back);
    records.insert(records.end(), scene.blended.begin(), scene.blended.end());
    return records;
}

std::uint32_t SceneTables::place_of_kind(const std::string &kind, std::uint32_t number_of_class) const {
    std::size_t place = 0;
    while (place < kinds.size() &&
           (kinds[place] != kind || (!kind_classes.empty() && kind_classes[place] != number_of_class)))
        ++place;
    return std::uint32_t(place);
}

SceneTables make_scene_tables(const Scene &scene, const TraitMap &traits, const LightTreeFrom &tree_from,
                              const MaterialClasses *classes) {
    SceneTables tables;
    const int indexed = traits.at("TRAIT_INDEXED");
    PrimitiveBuilder primitives(tables, indexed != 0);
    reserve_tables(scene, traits, tables, primitives);
    if (indexed != 0)
        add_vertices(scene, indexed, tables);
    if (classes) {
        for (const KindOfClass &one : kinds_by_class(scene, *classes)) {
            tables.kinds.push_back(one.kind);
            tables.kind_classes.push_back(one.number);
        }
    } else {
        tables.kinds = bsdf_kinds(scene);
    }
    LightBuilder lights(scene, tables, traits.at("TRAIT_TEXTURED_LIGHTS") != 0);
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::mesh)
            add_mesh(scene, shape, {scene, shape, tables, classes}, traits, tables, primitives, lights);
    tables.triangle_count = tables.primitive_count;
    for (const Shape &shape : scene.shapes)
        if (shape.kind == Shape::Kind::sphere)
            add_sphere(scene, shape, {scene, shape, tables, classes}, tables, primitives, lights);
    primitives.finish();
    const Bounds bounds = world_bounds(scene);
    const bool is_empty = !(bounds.lower[0] <= bounds.upper[0]);
    tables.bounds = is_empty ? Bounds{{0, 0, 0}, {0, 0, 0}} : bounds;
    const Double3 across = subtract(tables.bounds.upper, tables.bounds.lower);
    const double radius = is_empty ? 1 : std::max(0.5 * length(across), 1e-6);
    tables.scene_diameter = static_cast<float>(2.02 * radius);
    for (std::size_t axis = 0; axis < 3; ++axis)
        tables.scene_center[axis] = static_cast<float>(tables.bounds.lower[axis] + 0.5 * across[axis]);
    add_other_lights(scene, radius, tables, lights);
    lights.finish(tree_from);
    if (!tables.environment && traits.at("TRAIT_LIGHT_ENVIRONMENT"))
        tables.environment = std::make_shared<const EnvironmentMap>(no_environment_map());
    add_materials(scene, tables);
    if (traits.at("TRAIT_MATERIAL") || traits.at("TRAIT_TEXTURED_LIGHTS")) {
        add_textures(scene, tables);
        add_blends(scene, tables);
    }
    if (traits.at("TRAIT_NEAR_CLIP") || traits.at("TRAIT_FAR_CLIP"))
        tables.camera_clips = camera_clips(scene);
    tables.camera_kind = scene.camera.kind;
    tables.camera = make_camera_record(scene.camera, scene.film, tables.camera_clips);
    tables.filter = make_filter_table(scene.film);
    // Kernels compiled for both kinds of primitives read a record of each, whichever they then take.
    if (tables.triangles.empty())
        tables.triangles.resize(triangle_stride, 0.0f);
    if (tables.spheres.empty())
        tables.spheres.resize(sphere_stride, 0.0f);
    return tables;
}

std::size_t table_bytes(const SceneTables &t) {
    return (t.environment ? environment_bytes(*t.environment) : 0) +
           4 * (t.triangles.size() + t.triangle_normals.size() + t.triangle_tangents.size() + t.spheres.size() +
                t.materials.size() + t.lights.size() + t.camera.size() + t.primitive_surface.size() +
                t.primitive_material.size() + t.primitive_light.size() + t.primitive_bin.size() +
                t.primitive_back_bin.size() + t.material_back.size() + t.light_kinds.size() + t.light_alias.size() +
                t.emissions.size() + t.emission_alias.size() + t.triangle_texcoords.size() + t.sphere_axes.size() +
                t.texture_reals.size() + t.material_lookups.size() + t.textures.size() + t.texels.size() +
                t.material_textures.size() + t.blends.size() + t.record_kind.size() + t.blend_weights.size() +
                t.normal_maps.size() + t.bump_scales.size() + t.light_textures.size() + t.light_pictures.size() +
                t.light_tree.nodes.size() + t.light_tree.leaves.size() + t.light_tree.slots.size() +
                t.light_tree.leaf.size());
}

} // namespace gradus
