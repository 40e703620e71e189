// Turns the elements of a scene file into a Scene, plugin by plugin.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/document.h"
#include "runtime/io/properties.h"
#include "runtime/scene/scene.h"

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace gradus {

class SceneBuilder {
  public:
    SceneBuilder(const Document &document, const LoadLimits &limits, FileFinder &finder, Diagnostics &diagnostics);

    /// Errors go to the diagnostics; the scene is of use only if there are none.
    Scene build();

    // For plugins:

    /// The file that the string parameter "filename" names. A missing one is a SceneError.
    std::filesystem::path find_file(Properties &properties);
    /// A file's bytes. The last file is kept, since many shapes may come from one. They count as read where they come
    /// from the disk, and each time where the shape takes the file as a `whole`.
    const std::string &file_bytes(const std::filesystem::path &path, const Location &location, bool whole);
    /// Counts what a shape reads. Throws SceneError where all of them read more than the limit.
    void count_mesh_bytes(std::uint64_t bytes, const Location &location);
    const LoadLimits &limits() const { return limits_; }
    /// A picture that a texture names, decoded once. `is_srgb` becomes whether what is stored is sRGB. Throws
    /// SceneError.
    std::shared_ptr<const Bitmap> bitmap(const std::filesystem::path &path, bool is_linear, const std::string &channel,
                                         const Location &location, bool &is_srgb);
    /// The texture that an element describes, with its values clamped to the range: one of the scene's.
    FoundTexture texture(const Element &element, double lowest, double highest);
    /// A mixture of two sides of surfaces (Blend in runtime/scene/scene.h).
    Bsdf blend(const Bsdf &first, const Bsdf &second, const Number &weight);
    /// Whether light passes a side of a surface, or any part of a blend there.
    bool transmits(const Bsdf &bsdf) const;
    /// Builds a nested object by its plugin. Throws SceneError where its type is not known.
    template <typename Result>
    Result build_object(const Element &element);
    const ResolveReference &resolver() const { return resolve_; }
    Diagnostics &diagnostics() { return diagnostics_; }

  private:
    void index(const Element &element, int depth);
    void check_children(const Element &element);
    const Element &resolve(const Element &reference);
    void build_sensor(const Element &element);
    void build_integrator(const Element &element);
    void build_shape(const Element &element);
    void build_emitter(const Element &element);
    void check_unused_bsdf(const Element &element);
    std::uint32_t material_of(Properties &shape);
    std::int32_t emitter_of(Properties &shape);
    void count_geometry(const Mesh &mesh, const Location &location);
    void check_whole();

    const Document &document_;
    const LoadLimits limits_;
    FileFinder &finder_;
    Diagnostics &diagnostics_;
    ResolveReference resolve_;
    ReadTexture read_texture_;
    Scene scene_;
    std::map<std::string, const Element *> by_id_;
    std::map<std::string, std::string> aliases_;
    std::map<const Element *, std::uint32_t> materials_;
    /// Each is built once, however many refer to it, and fails once.
    std::map<const Element *, std::variant<Material, SceneError>> built_materials_;
    std::map<const Element *, Emitter> area_emitters_;
    std::map<const Element *, std::variant<Texture, SceneError>> built_textures_;
    std::map<std::tuple<const Element *, double, double>, FoundTexture> textures_;
    struct DecodedBitmap {
        std::shared_ptr<const Bitmap> bitmap;
        bool is_srgb;
    };
    std::map<std::tuple<std::filesystem::path, bool, std::string>, DecodedBitmap> bitmaps_;
    std::int64_t default_material_ = -1, default_emitter_material_ = -1;
    const Element *sensor_ = nullptr, *integrator_ = nullptr, *environment_ = nullptr;
    std::vector<const Element *> open_; ///< objects that are being built, outermost first
    std::filesystem::path cached_path_;
    std::string cached_bytes_;
    std::uint64_t mesh_bytes_ = 0, geometry_bytes_ = 0, texture_bytes_ = 0;
};

} // namespace gradus
