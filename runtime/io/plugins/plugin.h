// What a plugin of each category turns its properties into. A plugin is a file <category>_<name>.cpp beside this one
// that defines the functions declare_<category>_<name>, what files may say of it, and <category>_<name>, what that
// means. plugin_list.h, which names them all, is made of the files' names when the project is configured.
#pragma once

#include "runtime/io/mesh_files.h"
#include "runtime/io/plugins/catalogue.h"
#include "runtime/io/plugins/plugin_list.h"
#include "runtime/io/properties.h"
#include "runtime/io/scene_builder.h"
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/scene.h"

#include <functional>
#include <string>
#include <variant>
#include <vector>

namespace gradus {

struct ReconstructionFilter {
    FilmSettings::Filter filter = FilmSettings::Filter::gaussian;
    float radius = 2.0f, stddev = 0.5f; ///< in pixels
    float b = 1 / 3.0f, c = 1 / 3.0f;   ///< of Mitchell's
};

/// A sphere, and its center as it was before it was rounded.
struct PlacedSphere {
    Sphere sphere;
    Double3 center;
};

/// A mesh that is still to be read and built, by any thread.
struct PendingMesh {
    std::function<SerializedMesh()> read; ///< may throw SceneError; its face_normals is or-ed to that of the options
    Matrix4 to_world;
    MeshOptions options;
};

/// Shapes in a shape.
struct ShapeGroup {
    std::vector<const Element *> shapes; ///< not of an instance
    const Element *instanced = nullptr;  ///< the shapegroup that is seen once more
    Matrix4 to_world = {};               ///< of the instance
    Location location = {};              ///< of what says so
};

using ShapeGeometry = std::variant<BuiltMesh, PlacedSphere, PendingMesh, ShapeGroup>;

struct SampleCount {
    std::uint64_t count = 4; ///< samples a pixel
};

using bsdf_result = Material;
using emitter_result = Emitter;
using film_result = FilmSettings;
using integrator_result = RenderSettings;
using rfilter_result = ReconstructionFilter;
using sampler_result = SampleCount;
using sensor_result = Camera;
using shape_result = ShapeGeometry;
using texture_result = Texture;

#define GRADUS_PLUGIN_DECLARATION(category, name)                                                                      \
    Declaration declare_##category##_##name();                                                                         \
    category##_result category##_##name(Properties &properties, SceneBuilder &builder);
GRADUS_PLUGINS(GRADUS_PLUGIN_DECLARATION)
#undef GRADUS_PLUGIN_DECLARATION

template <typename Result>
struct Plugin {
    const Declaration *declaration = nullptr;
    Result (*build)(Properties &, SceneBuilder &) = nullptr;
    explicit operator bool() const { return build != nullptr; }
};

/// The plugin that the element names; false where there is none. The category is the element's tag.
template <typename Result>
Plugin<Result> find_plugin(const std::string &name);

} // namespace gradus
