// Typed access to what an element of a scene file says about one object. It keeps book of what was asked for, so that
// whatever the file says beyond that can be reported.
#pragma once

#include "runtime/io/diagnostics.h"
#include "runtime/io/element.h"
#include "runtime/io/spectrum.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

#include <functional>
#include <initializer_list>
#include <limits>
#include <set>
#include <string>
#include <vector>

namespace gradus {

/// Finds the element that a <ref> points to; throws SceneError.
using ResolveReference = std::function<const Element &(const Element &)>;

/// A texture of the scene: its index in Scene::textures and its values.
struct FoundTexture {
    std::int32_t index = no_texture;
    TextureRange range;
};
/// The texture that an element describes, whose values are clamped to a range.
using ReadTexture = std::function<FoundTexture(const Element &, double lowest, double highest)>;

/// Parameters are asked for by their snake_case names; files may spell them in camelCase. Every getter throws
/// SceneError where the file's value is not of its type or out of range, and returns `otherwise` where the file has
/// none.
class Properties {
  public:
    Properties(const Element &element, const ResolveReference &resolve, Diagnostics &diagnostics);

    const Element &element() const { return element_; }
    const Location &location() const { return element_.location; }
    /// Of the file's plugin, as in <bsdf type="diffuse">.
    std::string type() const;
    Diagnostics &diagnostics() { return diagnostics_; }

    bool has(const std::string &name);
    /// From here on, colours and numbers that materials have may be textures.
    void accept_textures(const ReadTexture *read) { read_texture_ = read; }

    double number(const std::string &name, double otherwise, double lowest = -std::numeric_limits<double>::infinity(),
                  double highest = std::numeric_limits<double>::infinity());
    std::int64_t integer(const std::string &name, std::int64_t otherwise, std::int64_t lowest, std::int64_t highest);
    bool boolean(const std::string &name, bool otherwise);
    std::string string(const std::string &name, const std::string &otherwise);
    Double3 point(const std::string &name, const Double3 &otherwise);
    /// The identity where the file has none.
    Matrix4 transform(const std::string &name);
    /// A reflectance may be a texture where those are accepted.
    Color color(const std::string &name, const Color &otherwise, ColorUse use);
    /// As color() of an emission, but it may be a texture where those are accepted.
    Color textured_emission(const std::string &name, const Color &otherwise);
    /// As number(), but it may be a texture where those are accepted. Both are clamped to `least` at least, and a
    /// texture to the range.
    Number textured_number(const std::string &name, const Number &otherwise, double lowest, double highest,
                           double least);
    /// A number, or the name of a material with an index of refraction.
    double refractive_index(const std::string &name, const std::string &otherwise);

    struct Object {
        const Element *element;
        Location location; ///< where it is used: the object itself or a <ref> to it
    };
    /// Nested objects of that tag, referenced ones too.
    std::vector<Object> objects(const std::string &tag);
    /// Names that may be there and have no meaning for this program.
    void ignore(std::initializer_list<const char *> names);
    /// Everything else may be there, too.
    void ignore_rest() { ignore_rest_ = true; }

    /// Reports parameters and nested objects that nobody asked for, with the nearest name that was.
    void report_unread();

    /// An error at the parameter, or at the object if the file does not have it.
    SceneError error(const std::string &name, const std::string &message);
    Location location_of(const std::string &name);

  private:
    const Element *find(const std::string &name);
    const std::string &value_of(const Element &property);
    Rgb read_spectrum(const Element &property, const std::string &name, ColorUse use);
    /// The texture that stands for a parameter, or nullptr.
    const Element *texture_of(const Element &property);
    Rgb read_color(const Element &property, const std::string &name, ColorUse use);

    const Element &element_;
    const ResolveReference &resolve_;
    Diagnostics &diagnostics_;
    const ReadTexture *read_texture_ = nullptr;
    std::set<const Element *> read_;
    std::vector<std::string> asked_;
    bool ignore_rest_ = false;
};

/// Tags of plugins, which may have an id and be referenced.
bool is_object_tag(const std::string &tag);
/// Tags of parameters.
bool is_property_tag(const std::string &tag);

} // namespace gradus
