// Turns the elements of a scene file into a Scene, plugin by plugin.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/document.h"
#include "runtime/io/properties.h"
#include "runtime/scene/scene.h"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gradus {

class SceneBuilder {
  public:
    SceneBuilder(const Document &document, Diagnostics &diagnostics);

    /// Errors go to the diagnostics; the scene is of use only if there are none.
    Scene build();

    // For plugins:

    /// The file that the string parameter "filename" names. A missing one is a SceneError.
    std::filesystem::path find_file(Properties &properties);
    /// A file's bytes. The last file is kept, since many shapes may come from one.
    const std::string &file_bytes(const std::filesystem::path &path, const Location &location);
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
    void check_whole();

    const Document &document_;
    Diagnostics &diagnostics_;
    ResolveReference resolve_;
    Scene scene_;
    std::map<std::string, const Element *> by_id_;
    std::map<std::string, std::string> aliases_;
    std::map<const Element *, std::uint32_t> materials_;
    std::int64_t default_material_ = -1, default_emitter_material_ = -1;
    const Element *sensor_ = nullptr, *integrator_ = nullptr, *environment_ = nullptr;
    std::vector<const Element *> open_; ///< objects that are being built, outermost first
    std::filesystem::path cached_path_;
    std::string cached_bytes_;
};

} // namespace gradus
