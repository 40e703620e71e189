// Turns the elements of a scene file into a Scene, plugin by plugin.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/document.h"
#include "runtime/io/file_search.h"
#include "runtime/io/load_options.h"
#include "runtime/io/mesh_files.h"
#include "runtime/io/picture_border.h"
#include "runtime/io/pictures_ahead.h"
#include "runtime/io/properties.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/scene.h"

#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <unordered_set>
#include <utility>
#include <variant>
#include <vector>

namespace gradus {

struct ShapeGroup;

/// A file of meshes, which several threads may ask for; it is read once.
class MeshFile {
  public:
    /// size: of the file when it was counted; a larger one is not read.
    MeshFile(const FileFinder &finder, std::filesystem::path path, std::uint64_t size, Location location)
        : finder_(finder), path_(std::move(path)), size_(size), location_(std::move(location)) {}
    const std::filesystem::path &path() const { return path_; }
    std::uint64_t size() const { return size_; }
    /// Throws SceneError at the shape that asked first where it cannot be read.
    const std::string &bytes();
    /// Where they were read from, links resolved; once they have been.
    const std::filesystem::path &place() const { return place_; }
    /// Of an OBJ file what it says, for shapes of some of its faces. Throws SceneError.
    const ObjFile &obj();

  private:
    const FileFinder &finder_;
    std::filesystem::path path_, place_;
    std::uint64_t size_;
    Location location_;
    std::mutex mutex_;
    std::optional<std::string> bytes_;
    std::mutex obj_mutex_;
    std::optional<std::variant<ObjFile, SceneError>> obj_;
};

class SceneBuilder {
  public:
    SceneBuilder(const Document &document, const LoadOptions &options, FileFinder &finder, Diagnostics &diagnostics);

    /// Errors go to the diagnostics; the scene is of use only if there are none.
    Scene build();

    // For plugins:

    /// The file that the string parameter "filename" names. A missing one is a SceneError.
    std::filesystem::path find_file(Properties &properties);
    /// The file of that name beside another one, or where find_file() looks.
    std::optional<FoundFile> look_for(const std::string &name, const std::filesystem::path &beside) const;
    /// What find_file() has found. Throws SceneError where it cannot be read.
    std::shared_ptr<const OpenFile> open_file(const std::filesystem::path &path, const Location &location) const;
    /// A file that a shape takes as a whole; it counts as read. Throws SceneError where that is too much.
    std::shared_ptr<MeshFile> mesh_file(const std::filesystem::path &path, const Location &location);
    /// The same of a file that many shapes may come from: the last ones are kept, and count once.
    std::shared_ptr<MeshFile> shared_mesh_file(const std::filesystem::path &path, const Location &location);
    /// Counts what a shape reads. Throws SceneError where all of them read more than the limit.
    void count_mesh_bytes(std::uint64_t bytes, const Location &location);
    const LoadLimits &limits() const { return limits_; }
    /// Names of mesh attributes that textures of the file ask for; meshes keep no others.
    std::vector<std::string> wanted_attributes() const {
        return {wanted_attributes_.begin(), wanted_attributes_.end()};
    }
    /// Counts the words of a picture. Throws SceneError where all pictures have more bytes than the limit.
    void count_texture_bytes(std::uint64_t words, const Location &location);
    /// A picture that a texture names, decoded once. `is_srgb` becomes whether what is stored is sRGB. Throws
    /// SceneError.
    std::shared_ptr<const Bitmap> bitmap(const Picture &picture, const Location &location, bool &is_srgb);
    /// The same with what lies around it, made once. Throws SceneError.
    std::shared_ptr<const Bitmap> bordered(const std::shared_ptr<const Bitmap> &inner, const PictureBorder &border,
                                           const Location &location);
    /// Whether a texture that is the same everywhere becomes one of the scene's, or its range tells all of it.
    enum class OneColor { is_texture, is_no_texture };
    /// The texture that an element describes, with its values clamped to the range: one of the scene's.
    FoundTexture texture(const Element &element, double lowest, double highest, StandsFor stands_for = StandsFor::color,
                         OneColor one_color = OneColor::is_texture);
    /// What texture() or a parameter has given an index of.
    const Texture &texture_at(std::int32_t index) const { return scene_.textures[std::size_t(index)]; }
    /// Such a texture, times a factor from 0 to 1.
    std::int32_t scaled(std::int32_t index, float factor);
    /// A mixture of two sides of surfaces (Blend in runtime/scene/scene.h). Throws SceneError where it has too many
    /// parts.
    Bsdf blend(const Bsdf &first, const Bsdf &second, const Number &weight, const Location &location);
    /// The material with a map under it, or under each part of a blend. Throws SceneError where one has a map already.
    Material with_map(Material material, const NormalTexture &map, const Location &location);
    /// set_coating() of runtime/scene/coating.h, worked out once for each kind, index and roughness.
    void set_coating(Bsdf &bsdf);
    /// Whether light passes a side of a surface, or any part of a blend there.
    bool transmits(const Bsdf &bsdf) const;
    /// Builds a nested object by its plugin. Throws SceneError where its type is not known.
    template <typename Result>
    Result build_object(const Element &element);
    /// Whether it is a BSDF or a <ref> to one.
    bool is_bsdf(const Element &child) const;
    /// An element that a plugin has made, kept as long as those of the file.
    const Element *keep(Element element) { return &made_.emplace_back(std::move(element)); }
    Diagnostics &diagnostics() { return diagnostics_; }
    /// May be nullptr.
    Phases *phases() const { return phases_; }

  private:
    Bsdf with_map(const Bsdf &bsdf, const NormalTexture &map, const Location &location);
    /// Throws SceneError where all blends together would hold too much with so many more.
    void check_blended(std::uint64_t more, const Location &location) const;
    template <typename Result>
    Result read_as(const Element &element, const std::string &type);
    void index(const Element &element, int depth);
    void want_attribute(const Element &texture);
    void begin_pictures();
    void settle_attributes(Mesh &mesh, const std::string &name, const Location &location);
    void check_attributes(const Shape &shape, const Mesh *mesh, const Location &location) const;
    TextureRange range_of(const Texture &texture);
    TextureRange unclamped_range_of(Texture texture);
    void check_children(const Element &element);
    std::string without_aliases(std::string name) const;
    const Element *find_by_id(const std::string &name) const;
    const Element &resolve(const Element &reference);
    std::unordered_set<const Element *> used_objects() const;
    void build_sensor(const Element &element);
    void build_integrator(const Element &element);
    const Element &innermost_integrator(const Element &element) const;
    struct ShapeInLine;
    /// A shape of a shapegroup.
    struct Prototype {
        const Element *element;
        std::variant<BuiltMesh, Sphere> geometry; ///< relative to the group's origin
        Double3 origin{0, 0, 0};                  ///< until the group has one: what it is relative to
        bool can_be_kept = false;                 ///< in instances: a mesh that does not emit
    };
    /// A shapegroup, once one of its instances is met.
    struct KnownGroup {
        std::vector<Prototype> prototypes;
        Double3 origin{0, 0, 0};        ///< in the frame of the file: what positions are relative to
        std::uint64_t bytes = 0;        ///< of an instance's copies of those that could be kept
        std::uint64_t instances = 0;    ///< so far
        std::int32_t number = no_group; ///< in the scene
    };
    /// What could be kept, and as which shapes of the scene it is copied.
    struct Copied {
        KnownGroup *group;
        Instance instance;
        std::vector<std::size_t> shapes;
    };
    void build_shapes(const std::vector<const Element *> &elements, std::vector<Prototype> *group);
    void put_in_line(const Element &element, bool in_group, std::vector<const Element *> &parents,
                     std::deque<ShapeInLine> &line);
    void build_line(std::deque<ShapeInLine> &line, std::vector<Prototype> *group);
    void check_parts(const Element &shape);
    /// Does work on one object, and tells what is wrong with it.
    template <class Work>
    void tell_errors(Work work) {
        try {
            work();
        } catch (const SceneError &error) {
            diagnostics_.error(error);
        }
    }
    void finish(ShapeInLine &shape, std::vector<Prototype> *group);
    void add_shape(const Element &element, std::variant<BuiltMesh, Sphere> geometry, std::int32_t group = no_group);
    KnownGroup &known_group(const Element &element);
    static Double3 settle_origin(std::vector<Prototype> &prototypes);
    void add_instance(const Element &element, const ShapeGroup &instance);
    void copy_prototype(const Element &element, const Prototype &prototype, const Matrix4 &to_world);
    void add_group(KnownGroup &group);
    void settle_instances();
    void check_media(const Element &element);
    std::uint32_t boundary_material();
    void build_emitter(const Element &element);
    void check_unused_bsdfs(const std::vector<const Element *> &elements);
    void check_unused_texture(const Element &element);
    std::uint32_t material_of(const Element &shape);
    std::int32_t emitter_of(const Element &shape);
    void count_geometry(std::uint64_t bytes, const Location &location);
    void warn_of_parts_of_no_sensor(const Element &root);
    void check_whole();
    /// An error for a sensor that stands where none is looked for; whether there is one.
    bool tell_sensor_elsewhere();
    /// A camera for a scene without one, and a warning.
    void see_all(const Location &location);

    const Document &document_;
    const LoadLimits limits_;
    const bool ignore_media_;
    Phases *const phases_;
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
    std::map<std::tuple<BsdfKind, float, float>, Bsdf> coatings_; ///< by kind, ior and alpha_u
    std::set<std::string> wanted_attributes_;
    std::vector<std::uint64_t> blend_parts_; ///< of each of the scene's blends
    std::map<const Element *, Emitter> area_emitters_;
    std::map<const Element *, std::variant<Texture, SceneError>> built_textures_;
    std::map<std::tuple<const Element *, double, double, StandsFor, OneColor>, FoundTexture> textures_;
    struct DecodedBitmap {
        std::shared_ptr<const Bitmap> bitmap;
        bool is_srgb;
    };
    std::map<Picture, DecodedBitmap> bitmaps_;
    std::map<std::pair<const Bitmap *, PictureBorder>, std::shared_ptr<const Bitmap>> bordered_;
    /// Of pictures: whether they are sRGB, times a scale, clamped from and to.
    std::map<std::tuple<const Bitmap *, bool, std::array<float, 3>, float, float>, TextureRange> ranges_;
    /// In place of pictures that no shape needs, while it is there: the bitmap of all that are not known.
    std::shared_ptr<const Bitmap> stand_in_;
    std::vector<const Element *> pictures_; ///< textures that name one, in the file's order
    std::set<std::string> missing_files_;   ///< as beside the file that names them
    std::set<const Element *> told_media_;  ///< that they are not rendered
    std::optional<PicturesAhead> pictures_ahead_;
    std::int64_t default_material_ = -1, default_emitter_material_ = -1, boundary_material_ = -1;
    const Element *sensor_ = nullptr, *integrator_ = nullptr, *environment_ = nullptr;
    std::vector<const Element *> open_;                   ///< objects that are being built, outermost first
    std::deque<Element> made_;                            ///< by plugins
    std::vector<std::shared_ptr<MeshFile>> shared_files_; ///< the last that was asked for is the last
    std::uint64_t mesh_bytes_ = 0, geometry_bytes_ = 0, shapes_in_line_ = 0, texture_bytes_ = 0;
    const InstanceChoice instance_choice_;
    const std::uint64_t most_copied_bytes_;
    std::map<const Element *, KnownGroup> groups_; ///< by shapegroup
    std::vector<Copied> copied_;                   ///< that may still become instances
    std::uint64_t copied_bytes_ = 0;               ///< up to most_copied_bytes_
};

} // namespace gradus
