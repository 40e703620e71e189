// Readers of mesh files. Each gives the mesh in the file's own coordinates: every index in range, normals and
// texcoords empty or one a vertex, attributes one a vertex or a triangle. Throws SceneError, which names the file and
// where it can the line.
#pragma once

#include "runtime/io/limits.h"
#include "runtime/scene/scene.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace gradus {

/// The faces of an OBJ file whose material, as the last `usemtl` before them names it, is one of these; or none of
/// them.
struct FacesOf {
    std::set<std::string> materials = {};
    bool others = true;
    bool has(const std::string &material) const { return materials.contains(material) != others; }
};

/// Wavefront OBJ: v, vt, vn, f with any mix of v, v/t, v//n, v/t/n and negative indices. Polygons become fans, and
/// faces of one or two corners triangles without area.
/// Everything else (groups, lines, curves) is skipped: all faces are one mesh. Messages quote a file only where it is
/// called .obj, links resolved: the format has no mark, and a scene can name any file. place: where the text was read
/// from; empty: where its name says.
Mesh parse_obj(const std::string &text, const std::string &file_name, const std::filesystem::path &place = {});

/// Such a file, read once for several meshes of some of its faces each.
class ObjFile {
  public:
    ObjFile(const std::string &text, const std::string &file_name, const std::filesystem::path &place = {});
    ObjFile(ObjFile &&) noexcept;
    ObjFile &operator=(ObjFile &&) noexcept;
    ~ObjFile();
    Mesh mesh(const FacesOf &faces) const;
    /// Whether a face has it.
    bool has_material(const std::string &material) const;

  private:
    struct Content;
    std::unique_ptr<Content> content_;
};

/// What the lines of an OBJ file name.
struct ObjNames {
    std::set<std::string> materials; ///< that faces have; "" of those without
    struct Library {
        std::string name;
        std::size_t line; ///< from 1
    };
    std::vector<Library> libraries; ///< of `mtllib`: whatever follows, one name with blanks in it or several
};
ObjNames names_in_obj(const std::string &text);

/// PLY, ASCII or binary of either byte order. Takes x y z, nx ny nz, u v (or s t) of "vertex", the index list of "face"
/// and its list "texcoord" (u and v of each corner, which go before those of the vertices), and what makes the
/// attributes that are wanted (ply_attributes.h); skips every other element and property. Polygons become fans, and
/// faces of fewer than three corners triangles without area.
Mesh parse_ply(const std::string &data, const std::string &file_name, const std::vector<std::string> &attributes = {});

struct SerializedMesh {
    Mesh mesh;
    bool face_normals = false;        ///< the file asks for flat shading
    std::uint64_t unfolded_bytes = 0; ///< of the stream that it was read from
};
/// Mesh `index` (from 0) of a file in Mitsuba's serialized format, versions 3 and 4. Of the limits those of what a
/// stream may unfold to count. Its colours become the attribute "vertex_color" where that is wanted.
SerializedMesh parse_serialized(const std::string &data, const std::string &file_name, std::uint64_t index,
                                const LoadLimits &limits = {}, const std::vector<std::string> &attributes = {});

} // namespace gradus
