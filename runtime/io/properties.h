// Typed access to what an element of a scene file says about one object, by what its plugin declares; whatever the file
// says beyond that can be reported.
#pragma once

#include "runtime/io/declaration.h"
#include "runtime/io/diagnostics.h"
#include "runtime/io/element.h"
#include "runtime/io/spectrum.h"
#include "runtime/scene/scene.h"
#include "runtime/scene/transform.h"

#include <functional>
#include <initializer_list>
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
/// What a texture stands for. As a number a picture's texel is its luminance, any other colour the mean of its channels
/// (as in Mitsuba 3.9).
enum class StandsFor { color, number };
/// The texture that an element describes, whose values are clamped to a range.
using ReadTexture = std::function<FoundTexture(const Element &, double lowest, double highest, StandsFor)>;

struct NestedObject {
    const Element *element;
    Location location; ///< where it is used: the object itself or a <ref> to it
};
/// Objects of that tag in an element, referenced ones too.
std::vector<NestedObject> nested_objects(const Element &element, const std::string &tag,
                                         const ResolveReference &resolve);
/// The first of objects of which one alone counts, with a warning for each other; nullptr where there is none.
const Element *the_one_of(const std::vector<NestedObject> &found, Diagnostics &diagnostics);
/// The warning for all but one of them.
void warn_of_others(const std::vector<NestedObject> &found, const NestedObject &kept, Diagnostics &diagnostics);
/// Of the element's plugin, as in <bsdf type="diffuse">.
std::string type_of(const Element &element);
/// For messages: <bsdf type="diffuse">.
std::string described(const Element &element);

/// Parameters are asked for by their snake_case names; files may spell them in camelCase. Only what the declaration has
/// can be asked for, in the getter of its type: all else is a defect of the program, a std::logic_error. Every getter
/// throws SceneError where the file's value is not of its type or out of range, and returns the declared default where
/// the file has none.
class Properties {
  public:
    /// The declaration and the resolver must outlive it. `read_texture`: nullptr where nothing takes textures.
    Properties(const Element &element, const Declaration &declaration, const ResolveReference &resolve,
               Diagnostics &diagnostics, const ReadTexture *read_texture = nullptr);

    const Element &element() const { return element_; }
    const Location &location() const { return element_.location; }
    std::string type() const { return type_of(element_); }
    Diagnostics &diagnostics() { return diagnostics_; }

    bool has(const std::string &name);
    /// Of a parameter of any type the very text, without blanks around it; empty where the file has none.
    std::string written(const std::string &name);

    double number(const std::string &name);
    std::int64_t integer(const std::string &name);
    /// Within these bounds, too.
    std::int64_t integer(const std::string &name, std::int64_t lowest, std::int64_t highest);
    bool boolean(const std::string &name);
    /// Of a string or a file's name.
    std::string string(const std::string &name);
    /// In lower case.
    std::string choice(const std::string &name);
    Double3 point(const std::string &name);
    /// The identity where the file has none.
    Matrix4 transform(const std::string &name);
    /// A colour, which may be a texture where the parameter takes one. Reflectances are at most 1, or made so with a
    /// warning.
    Color color(const std::string &name);
    /// The same, but a reflectance that is no texture may be above 1.
    Color color_as_written(const std::string &name);
    /// A number, which may be a texture, or a colour, whose channels' mean it is then. Its value is a texture's least,
    /// and `most` its largest.
    Number textured_number(const std::string &name, float *most = nullptr);
    double refractive_index(const std::string &name);
    std::vector<NestedObject> objects(const std::string &tag);

    /// Reports parameters and nested objects that are not declared, with the nearest name that is.
    void report_unknown();

    /// An error at the parameter, or at the object if the file does not have it.
    SceneError error(const std::string &name, const std::string &message);
    Location location_of(const std::string &name);

  private:
    const Parameter &declared(const std::string &name, std::initializer_list<Takes> types) const;
    std::string referenced_tag(const Element &reference) const;
    void report_children(const Element &child);
    const Element *find(const std::string &name);
    const Element *find(const Parameter &parameter);
    const std::string &value_of(const Element &property);
    /// What the file says, or the default as if the file said it.
    std::string text_of(const Parameter &parameter, const Element *property);
    double number_of(const Parameter &parameter, const Element *property);
    /// What was written as `text`, where that is within the parameter's bounds.
    double within_bounds(const Parameter &parameter, double value, const std::string &text);
    Double3 read_rgb(const std::string &text, const Parameter &parameter, const Location &location);
    Rgb read_spectrum(const Element &property, const std::string &name, ColorUse use);
    Rgb read_black_body(const Element &property, const std::string &name, ColorUse use);
    /// The texture that stands for a parameter, or nullptr. A spectrum that is a plugin, <spectrum type="d65">, is one.
    const Element *texture_of(const Element &property);
    Color color_of_texture(const Element &texture, double highest);
    Rgb read_color(const Element &property, const Parameter &parameter, ColorUse use);

    const Element &element_;
    const Declaration &declaration_;
    const ResolveReference &resolve_;
    Diagnostics &diagnostics_;
    const ReadTexture *read_texture_;
};

/// Tags of plugins, which may have an id and be referenced.
bool is_object_tag(const std::string &tag);
/// Those of objects and of properties.
std::vector<std::string> all_tags();
/// Tags of parameters.
bool is_property_tag(const std::string &tag);

} // namespace gradus
