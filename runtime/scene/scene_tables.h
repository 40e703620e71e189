// A scene laid out as the kernels read it: the records of kernels/shared/scene_records.h and material.h.
#pragma once

#include "runtime/scene/bounds.h"
#include "runtime/scene/camera_clips.h"
#include "runtime/scene/filter_table.h"
#include "runtime/scene/light_tree.h"
#include "runtime/scene/material_class.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/traits.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

constexpr std::uint32_t no_light_tree = 0xFFFFFFFFu;

/// Lights that are not at infinity are chosen by a tree from so many of them on, or from so many emitters, of which
/// they are parts.
struct LightTreeFrom {
    std::uint32_t lights = no_light_tree, emitters = no_light_tree;
};

/// One triangle, and its corners: with TRAIT_INDEXED vertices, else 0.
struct TableTriangle {
    std::array<float, 3> p0, e1, e2;
    std::array<std::uint32_t, 3> corners;
};

struct SceneTables {
    /// With TRAIT_INDEXED all that is of triangles is in the first of these: indices, then vertices.
    std::vector<float> triangles, triangle_normals, triangle_tangents, spheres, materials, lights, camera;
    /// By primitive. The material bears the bit material_two_sided; the bins are those of `classify`, by the side.
    std::vector<std::uint32_t> primitive_material, primitive_light, primitive_bin, primitive_back_bin;
    /// With TRAIT_INDEXED in place of these four.
    std::vector<std::uint32_t> primitive_surface;
    /// Only where textures are: kernels/shared/texture.h.
    std::vector<float> triangle_texcoords, sphere_axes, texture_reals;
    std::vector<std::uint32_t> textures, texels, material_textures, material_lookups, normal_maps;
    std::vector<float> bump_scales;
    /// By light, only where lights have textures; of the last, three numbers, what the value is times in the mean.
    std::vector<std::uint32_t> light_textures;
    std::vector<float> light_pictures, light_means;
    /// By material record, where materials are blended: records of kernels/shared/texture.h, and the place in `kinds`.
    std::vector<std::uint32_t> blends, record_kind;
    std::vector<float> blend_weights;
    std::vector<std::uint32_t> material_back;            ///< by material record: the record of its back
    std::vector<std::uint32_t> light_kinds, light_alias; ///< by light
    /// By light, what light paths choose by: records of kernels/shared/scene_records.h, and the alias.
    std::vector<float> emissions;
    std::vector<std::uint32_t> emission_alias;
    LightTree light_tree;                              ///< of no levels where lights are chosen by power
    float light_share_at_infinity = 0;                 ///< with a tree: how often a light at infinity is chosen
    std::shared_ptr<const EnvironmentMap> environment; ///< where the environment is a map, or kernels expect one
    std::vector<std::string> kinds; ///< the BSDF kinds of the scene: kind k has the bins 1 + 2 k and 2 + 2 k
    /// By kind the class of its materials, as in KindOfClass, where a kind is there once for each; else empty.
    std::vector<std::uint32_t> kind_classes;
    std::uint32_t primitive_count = 0, triangle_count = 0, light_count = 0, environment_light = 0;
    /// With TRAIT_INDEXED how many numbers a vertex has, the number of the first, and that past the last; else 0.
    std::uint32_t vertex_numbers = 0, first_vertex = 0, end_vertex = 0;
    /// With TRAIT_INSTANCES the record of what is in no instance, in `triangles`; those of Scene::instances follow.
    std::uint32_t no_instance = 0;
    Bounds bounds;                          ///< of all that can be hit, and maybe a little more; a point if nothing can
    float scene_diameter = 1;               ///< longer than any segment within the scene; of a sphere that holds it
    std::array<float, 3> scene_center = {}; ///< of that sphere
    CameraClips camera_clips;
    FilterTable filter;
    Camera::Kind camera_kind = Camera::Kind::perspective;

    bool is_indexed() const { return vertex_numbers > 0; }
    /// The place in `kinds` of a kind on materials of a class, which counts where there are classes; past the last
    /// where it is not there, as of blends.
    std::uint32_t place_of_kind(const std::string &kind, std::uint32_t number_of_class) const;
    /// In its group's frame where it is of one.
    TableTriangle triangle(std::uint32_t number) const;
    /// A triangle of an instance, by the record of that.
    TableTriangle triangle(std::uint32_t number, std::uint32_t instance) const;
    /// u and v of its corners, where there are textures.
    std::array<float, 6> texcoords(std::uint32_t triangle) const;
    /// What kernels know by LIGHT_OF_PRIMITIVE.
    std::uint32_t light_of(std::uint32_t primitive) const;
};

/// Lays out the scene for these traits. `classes`: surfaces of a kind are kept apart by class too.
SceneTables make_scene_tables(const Scene &scene, const TraitMap &traits, const LightTreeFrom &tree_from = {},
                              const MaterialClasses *classes = nullptr);

/// The BSDF of each material record: the fronts of all materials, then the backs that differ from them, then what
/// blends are made of.
std::vector<Bsdf> material_records(const Scene &scene);

/// Bytes that the tables take.
std::size_t table_bytes(const SceneTables &tables);

} // namespace gradus
