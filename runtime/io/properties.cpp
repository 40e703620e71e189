#include "runtime/io/properties.h"

#include "runtime/io/refractive_index.h"
#include "runtime/io/text.h"
#include "runtime/io/transform_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

namespace gradus {

namespace {
template <std::size_t size>
bool is_one_of(const std::string &tag, const char *const (&tags)[size]) {
    return std::any_of(std::begin(tags), std::end(tags), [&](const char *other) { return tag == other; });
}

constexpr const char *object_tags[] = {"integrator", "sensor",  "film",   "sampler", "rfilter", "bsdf",      "shape",
                                       "emitter",    "texture", "medium", "phase",   "volume",  "subsurface"};
constexpr const char *property_tags[] = {"boolean", "integer", "float",    "string",    "point",     "vector",
                                         "rgb",     "srgb",    "spectrum", "blackbody", "transform", "animation"};
} // namespace

std::vector<std::string> all_tags() {
    std::vector<std::string> all(std::begin(object_tags), std::end(object_tags));
    all.insert(all.end(), std::begin(property_tags), std::end(property_tags));
    return all;
}

bool is_object_tag(const std::string &tag) { return is_one_of(tag, object_tags); }
bool is_property_tag(const std::string &tag) { return is_one_of(tag, property_tags); }

std::string type_of(const Element &element) { return std::string(trimmed(element.attribute_or("type", ""))); }

std::string described(const Element &element) {
    const std::string type = element.attribute_or("type", "");
    return "<" + element.tag + (type.empty() ? "" : " type=\"" + type + "\"") + ">";
}

std::vector<NestedObject> nested_objects(const Element &element, const std::string &tag,
                                         const ResolveReference &resolve) {
    std::vector<NestedObject> found;
    for (const Element &child : element.children)
        if (const Element *target = child.tag == "ref" ? &resolve(child) : &child; target->tag == tag)
            found.push_back({target, child.location});
    return found;
}

void warn_of_others(const std::vector<NestedObject> &found, const NestedObject &kept, Diagnostics &diagnostics) {
    for (const NestedObject &one : found)
        if (&one != &kept)
            diagnostics.warn(one.location, "a second <" + kept.element->tag +
                                               "> is ignored; the one that counts is at " + kept.location.text());
}

const Element *the_one_of(const std::vector<NestedObject> &found, Diagnostics &diagnostics) {
    if (found.empty())
        return nullptr;
    warn_of_others(found, found.front(), diagnostics);
    return found.front().element;
}

Properties::Properties(const Element &element, const Declaration &declaration, const ResolveReference &resolve,
                       Diagnostics &diagnostics, const ReadTexture *read_texture)
    : element_(element), declaration_(declaration), resolve_(resolve), diagnostics_(diagnostics),
      read_texture_(read_texture) {}

const Parameter &Properties::declared(const std::string &name, std::initializer_list<Takes> types) const {
    const Parameter *parameter = declaration_.find(name);
    if (!parameter)
        throw std::logic_error("a plugin asks for \"" + name + "\", which it does not declare");
    if (types.size() > 0 && std::find(types.begin(), types.end(), parameter->takes) == types.end())
        throw std::logic_error("a plugin asks for \"" + name + "\" as another type than it declares");
    return *parameter;
}

const Element *Properties::find(const Parameter &parameter) {
    const Element *found = find(parameter.name);
    return found || !parameter.also_named ? found : find(parameter.also_named);
}

const Element *Properties::find(const std::string &name) {
    const Element *found = nullptr;
    for (const Element &child : element_.children) {
        const std::string *child_name = child.attribute("name");
        if (!child_name || snake_case(trimmed(*child_name)) != name)
            continue;
        // Any object may carry a name; only a texture stands for a parameter.
        if (!is_property_tag(child.tag) && child.tag != "texture" && child.tag != "ref")
            continue;
        if (child.tag == "ref" && resolve_(child).tag != "texture" && resolve_(child).tag != "spectrum")
            continue;
        if (found)
            diagnostics_.warn(child.location, "\"" + name + "\" is given twice; this one counts");
        found = &child;
    }
    return found;
}

SceneError Properties::error(const std::string &name, const std::string &message) {
    return SceneError(location_of(name), message);
}

Location Properties::location_of(const std::string &name) {
    const Element *property = find(declared(name, {}));
    return property ? property->location : element_.location;
}

const std::string &Properties::value_of(const Element &property) {
    const std::string name = property.attribute_or("name", "");
    const bool is_plugin = property.tag == "spectrum" && property.attribute("type");
    if (!is_property_tag(property.tag) || property.tag == "transform" || is_plugin)
        throw SceneError(property.location, "\"" + name + "\" cannot be a " + described(property));
    const std::string *value = property.attribute("value");
    if (!value)
        throw SceneError(property.location, "<" + property.tag + " name=\"" + name + "\"> has no value");
    return *value;
}

std::string Properties::text_of(const Parameter &parameter, const Element *property) {
    if (property)
        return value_of(*property);
    if (parameter.is_required) {
        const bool is_vowel = std::string("aeiou").find(parameter.name[0]) != std::string::npos;
        throw SceneError(element_.location, type() + " needs " + (is_vowel ? "an " : "a ") + parameter.name);
    }
    const char *otherwise =
        element_.is_legacy() && parameter.otherwise_before_2 ? parameter.otherwise_before_2 : parameter.otherwise;
    if (!otherwise)
        throw std::logic_error("\"" + parameter.name + "\" has no default; a plugin must ask whether it is there");
    return otherwise;
}

bool Properties::has(const std::string &name) { return find(declared(name, {})) != nullptr; }

std::string Properties::written(const std::string &name) {
    const Element *property = find(declared(name, {}));
    return std::string(trimmed(property ? property->attribute_or("value", "") : ""));
}

double Properties::number(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::number});
    const Element *property = find(parameter);
    if (!property && parameter.like)
        return number(parameter.like);
    return number_of(parameter, property);
}

double Properties::number_of(const Parameter &parameter, const Element *property) {
    const std::string &name = parameter.name, text = text_of(parameter, property);
    const std::optional<double> value = parse_number(text);
    if (!value)
        throw error(name, "\"" + name + "\" needs a number, not \"" + text + "\"");
    return within_bounds(parameter, *value, text);
}

double Properties::within_bounds(const Parameter &parameter, double value, const std::string &text) {
    if (value < parameter.lowest || value > parameter.highest) {
        std::string range;
        const auto show = [](double bound) { return fmt::format("{:.10g}", bound); };
        if (std::isfinite(parameter.lowest))
            range += "at least " + show(parameter.lowest);
        if (std::isfinite(parameter.highest))
            range += (range.empty() ? "" : " and ") + ("at most " + show(parameter.highest));
        throw error(parameter.name, "\"" + std::string(parameter.name) + "\" is " + text + " but must be " + range);
    }
    return std::max(parameter.least, value);
}

Number Properties::textured_number(const std::string &name, float *most) {
    const Parameter &parameter = declared(name, {Takes::textured_number});
    const Element *property = find(parameter);
    if (!property && parameter.like)
        return textured_number(parameter.like, most);
    const auto constant = [&](double number) {
        if (most)
            *most = float(number);
        return Number(float(number));
    };
    const Element *texture = property ? texture_of(*property) : nullptr;
    if (!texture && property && (property->tag == "rgb" || property->tag == "srgb" || property->tag == "spectrum")) {
        const Rgb color = read_color(*property, parameter, ColorUse::index);
        return constant(within_bounds(parameter, (color.r + color.g + color.b) / 3, value_of(*property)));
    }
    if (!texture)
        return constant(number_of(parameter, property));
    const FoundTexture found =
        (*read_texture_)(*texture, std::max(parameter.lowest, parameter.least), parameter.highest, StandsFor::number);
    if (most)
        *most = float(*std::max_element(found.range.most.begin(), found.range.most.end()));
    Number result(float(*std::min_element(found.range.least.begin(), found.range.least.end())));
    result.texture = found.index;
    return result;
}

const Element *Properties::texture_of(const Element &property) {
    if (!read_texture_)
        return nullptr;
    const Element &target = property.tag == "ref" ? resolve_(property) : property;
    const bool is_plugin = target.tag == "texture" || (target.tag == "spectrum" && target.attribute("type"));
    return is_plugin ? &target : nullptr;
}

std::int64_t Properties::integer(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::integer});
    using Limits = std::numeric_limits<std::int64_t>;
    return integer(name, std::isfinite(parameter.lowest) ? std::int64_t(parameter.lowest) : Limits::min(),
                   std::isfinite(parameter.highest) ? std::int64_t(parameter.highest) : Limits::max());
}

std::int64_t Properties::integer(const std::string &name, std::int64_t lowest, std::int64_t highest) {
    const Parameter &parameter = declared(name, {Takes::integer});
    const std::string text = text_of(parameter, find(parameter));
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value)
        throw error(name, "\"" + name + "\" needs an integer, not \"" + text + "\"");
    if (*value < lowest || *value > highest)
        throw error(name, "\"" + name + "\" is " + text + " but must be from " + std::to_string(lowest) + " to " +
                              std::to_string(highest));
    return *value;
}

bool Properties::boolean(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::boolean});
    const std::string text = text_of(parameter, find(parameter));
    const std::optional<bool> value = parse_boolean(text);
    if (!value)
        throw error(name, "\"" + name + "\" needs true or false, not \"" + text + "\"");
    return *value;
}

std::string Properties::string(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::string, Takes::filename});
    const std::string text(trimmed(text_of(parameter, find(parameter))));
    if (text.empty() && parameter.is_required)
        throw error(name, "\"" + name + "\" is empty");
    return text;
}

std::string Properties::choice(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::choice});
    const Element *property = find(parameter);
    if (!property && parameter.like)
        return choice(parameter.like);
    const std::string text = lower_case(trimmed(text_of(parameter, property)));
    if (std::ranges::find(parameter.words, text) == parameter.words.end())
        throw error(name, "unknown " + name + " \"" + text + "\" (known: " + join(parameter.words) + ")");
    return text;
}

Double3 Properties::point(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::point});
    const Element *property = find(parameter);
    if (property && property->tag != "point" && property->tag != "vector")
        throw SceneError(property->location,
                         "\"" + name + "\" needs a <point> or <vector>, not a <" + property->tag + ">");
    if (!property || property->attribute("value")) {
        const std::string text = text_of(parameter, property);
        const std::optional<std::vector<double>> values = parse_numbers(text);
        if (values && values->size() == 1) // for all three
            return {values->front(), values->front(), values->front()};
        if (!values || values->size() != 3)
            throw error(name, "\"" + name + "\" needs three numbers, not \"" + text + "\"");
        return {(*values)[0], (*values)[1], (*values)[2]};
    }
    Double3 result{0, 0, 0};
    const char *const axes[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i)
        if (const std::string *text = property->attribute(axes[i])) {
            const std::optional<double> value = parse_number(*text);
            if (!value)
                throw SceneError(property->location,
                                 std::string(axes[i]) + " of \"" + name + "\" is not a number: \"" + *text + "\"");
            result[i] = *value;
        }
    return result;
}

namespace {

/// When a shutter opens, unless told otherwise: the last one until then, or the first of all.
const Element &keyframe_at_start(const Element &animation) {
    constexpr double start = 0;
    const Element *found = nullptr;
    double time_of_found = 0;
    for (const Element &frame : animation.children) {
        const std::optional<double> time = parse_number(frame.attribute_or("time", ""));
        if (frame.tag != "transform" || !time)
            throw SceneError(frame.location, "an <animation> consists of <transform>s with a time each");
        const bool is_better = *time <= start ? time_of_found > start || *time > time_of_found : *time < time_of_found;
        if (!found || is_better) {
            found = &frame;
            time_of_found = *time;
        }
    }
    if (!found)
        throw SceneError(animation.location, "an <animation> without a keyframe says nothing");
    return *found;
}

} // namespace

Matrix4 Properties::transform(const std::string &name) {
    const Element *property = find(declared(name, {Takes::transform}));
    if (!property)
        return {};
    if (property->tag == "animation") {
        property = &keyframe_at_start(*property);
        diagnostics_.warn(property->location, "\"" + name +
                                                  "\": motion is not supported; all stands still as at this "
                                                  "keyframe");
    }
    if (property->tag != "transform")
        throw SceneError(property->location, "\"" + name + "\" needs a <transform>, not a <" + property->tag + ">");
    return read_transform(*property, diagnostics_);
}

double Properties::refractive_index(const std::string &name) {
    const Parameter &parameter = declared(name, {Takes::refractive_index});
    const std::string text(trimmed(text_of(parameter, find(parameter))));
    const std::optional<double> index = dielectric_index(text);
    const std::optional<double> value = index ? index : parse_number(text);
    if (!value) {
        std::string message = "\"" + name + "\" is \"" + text + "\", which is no number and no material known here";
        if (const auto nearest = nearest_name(text, dielectric_names()))
            message += "; did you mean \"" + *nearest + "\"?";
        throw error(name, message + " (known: " + join(dielectric_names()) + ")");
    }
    if (*value < 1e-3 || *value > 1e3)
        throw error(name, "\"" + name + "\" is " + text + "; an index of refraction is positive and moderate");
    return *value;
}

std::vector<NestedObject> Properties::objects(const std::string &tag) {
    if (!declaration_.find_objects(tag))
        throw std::logic_error("a plugin asks for nested objects <" + tag + ">, which it does not declare");
    return nested_objects(element_, tag, resolve_);
}

void Properties::report_unknown() {
    std::vector<std::string> names;
    for (const Parameter &parameter : declaration_.parameters)
        if (parameter.takes != Takes::objects) {
            names.push_back(parameter.name);
            if (parameter.also_named)
                names.push_back(parameter.also_named);
        }
    const std::string owner = element_.tag + (type().empty() ? "" : " \"" + type() + "\"");
    for (const Element &child : element_.children) {
        const std::string *written = child.attribute("name");
        const std::string name = snake_case(trimmed(written ? *written : ""));
        const bool is_reference = child.tag == "ref", is_parameter = std::ranges::count(names, name) > 0;
        const std::string tag = is_reference ? referenced_tag(child) : child.tag;
        if (element_.tag == "bsdf" && element_.is_legacy() && name == "ensure_energy_conservation")
            continue; // of all BSDFs of 0.x; what it asks for is done
        if (declaration_.find_objects(tag) || (is_parameter && (is_property_tag(tag) || tag == "texture"))) {
            report_children(child);
            continue;
        }
        if (is_property_tag(child.tag) || (child.tag == "texture" && written)) {
            std::string message = "unknown parameter \"" + (written ? *written : "") + "\" of " + owner;
            if (const auto nearest = diagnostics_.is_full() ? std::nullopt : nearest_name(name, names))
                message += "; did you mean \"" + *nearest + "\"?";
            diagnostics_.unknown(child.location, message);
        } else if (is_reference)
            diagnostics_.unknown(child.location,
                                 "<ref id=\"" + child.attribute_or("id", "") + "\"> in " + owner + " is not used");
        else
            diagnostics_.unknown(child.location, "<" + child.tag + "> in " + owner + " is not used");
    }
}

/// Of what holds a value alone, or names something else.
void Properties::report_children(const Element &child) {
    const bool is_step_list = child.tag == "transform" || child.tag == "animation";
    if (child.tag != "ref" && (!is_property_tag(child.tag) || is_step_list || child.attribute("type")))
        return;
    for (const Element &inner : child.children)
        diagnostics_.unknown(inner.location, "<" + inner.tag + "> in <" + child.tag + "> is not used");
}

/// Empty where it leads nowhere.
std::string Properties::referenced_tag(const Element &reference) const {
    try {
        return resolve_(reference).tag;
    } catch (const SceneError &) {
        return "";
    }
}

} // namespace gradus
