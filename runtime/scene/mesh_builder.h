// From a mesh as a file holds it to the mesh that is rendered: in world space, clean, its sides settled.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

#include <cstddef>

namespace gradus {

struct MeshOptions {
    bool face_normals = false; ///< drop vertex normals, and compute none
    bool flip_normals = false; ///< the other side becomes the front
    /// The front is where the local geometric normal points, mapped as normals are (rectangle, cube). False for
    /// files: there the vertex normals tell the front if there are any, else the order of the vertices in world space.
    bool front_from_local_winding = false;
    /// Mapped normals are as long as the map makes them, over what it makes a volume's faces in the mean: interpolated
    /// they are then what the map makes of interpolated ones, as of an instance. Else they are unit vectors.
    bool normals_keep_proportions = false;
    bool compute_normals = true; ///< smooth vertex normals where the mesh brings none
};

struct BuiltMesh {
    Mesh mesh;                  ///< may be left without triangles
    std::size_t degenerate = 0; ///< triangles dropped: of no area, or with a corner that is not finite
};

/// Transforms, drops degenerate triangles, computes vertex normals where they are wanted and absent, and orders each
/// triangle so that (p1 - p0) x (p2 - p0) points to the front side. `mesh` is in local space; every index is in
/// range; normals and texcoords are empty or one a vertex; attributes have as many values as they say.
BuiltMesh build_mesh(Mesh mesh, const Matrix4 &to_world, const MeshOptions &options);

/// Adds up the normals of the triangles at each vertex, weighted by the angle there (Thuermer and Wuethrich 1998,
/// "Computing vertex normals from polygonal facets"). Normals of vertices without a triangle are (0, 0, 1).
std::vector<Vector3> smooth_vertex_normals(const Mesh &mesh);

/// Twice the area of a triangle, along its geometric normal.
Double3 area_vector(const Mesh &mesh, const std::array<std::uint32_t, 3> &triangle);

/// Sum of the areas of the triangles, in square scene units.
double surface_area(const Mesh &mesh);

/// That its vertices and triangles take.
std::uint64_t mesh_bytes(const Mesh &mesh);

} // namespace gradus
