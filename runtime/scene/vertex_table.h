// Vertices that triangles share, and surfaces that primitives do: the tables of scenes with many triangles, where
// records for each would take several times what files hold. kernels/shared/scene_records.h says how they lie.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/traits.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace gradus {

struct SceneTables;

/// Scenes with more triangles than this have them by index. Up to it records of their own take 8 MB at most. Either is
/// as fast (docs/design.md).
constexpr std::size_t most_dense_triangles = 1u << 16;

/// TRAIT_INDEXED of a scene that has these other traits and so many triangles: how many numbers a vertex has.
/// Scenes with instances have them by index in any case.
int indexed_trait(const TraitMap &traits, std::size_t triangles);

/// Lays out the indices and vertices of all meshes, in the order of the shapes, and instances behind them.
void add_vertices(const Scene &scene, int numbers, SceneTables &tables);

/// (u, v) of a triangle of a mesh that has none.
extern const std::array<std::array<float, 2>, 3> unit_texcoords;

/// Where (u, v) is read of a mesh that has none, each triangle has those of the unit triangle, and so vertices of its
/// own: three for each, in their order.
bool has_own_vertices(const Scene &scene, const Shape &shape);
/// How many vertices the mesh of a shape has in these tables.
std::size_t table_vertex_count(const Scene &scene, const Shape &shape);

/// Bytes that triangles and primitives take in the tables of a scene with these traits.
std::uint64_t geometry_table_bytes(const Scene &scene, const TraitMap &traits);

/// By primitive which surface it has, each surface once.
class SurfaceTable {
  public:
    /// A primitive after those that are there. `light`: its number, or no_light.
    void add(std::uint32_t material, std::uint32_t bin, std::uint32_t back_bin, std::uint32_t light);
    /// As many that do not emit.
    void add_unlit(std::uint32_t material, std::uint32_t bin, std::uint32_t back_bin, std::size_t count);
    void reserve(std::size_t primitives) { of_primitive_.reserve(primitives + 64); }
    /// The table; nothing can be added after.
    std::vector<std::uint32_t> finish();

  private:
    using Surface = std::array<std::uint32_t, 4>; ///< GRADUS_SURFACE_FIELDS
    std::uint32_t number_of(const Surface &surface);

    std::vector<std::uint32_t> of_primitive_;
    std::vector<Surface> surfaces_;
    std::map<Surface, std::uint32_t> known_;
};

} // namespace gradus
