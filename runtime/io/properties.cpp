#include "runtime/io/properties.h"

#include "runtime/io/refractive_index.h"
#include "runtime/io/text.h"
#include "runtime/io/transform_reader.h"

#include <algorithm>
#include <cmath>

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

bool is_object_tag(const std::string &tag) { return is_one_of(tag, object_tags); }
bool is_property_tag(const std::string &tag) { return is_one_of(tag, property_tags); }

Properties::Properties(const Element &element, const ResolveReference &resolve, Diagnostics &diagnostics)
    : element_(element), resolve_(resolve), diagnostics_(diagnostics) {}

std::string Properties::type() const { return std::string(trimmed(element_.attribute_or("type", ""))); }

const Element *Properties::find(const std::string &name) {
    if (std::find(asked_.begin(), asked_.end(), name) == asked_.end())
        asked_.push_back(name);
    const Element *found = nullptr;
    for (const Element &child : element_.children) {
        const std::string *child_name = child.attribute("name");
        if (!child_name || snake_case(trimmed(*child_name)) != name)
            continue;
        // Any object may carry a name; only a texture stands for a parameter.
        if (!is_property_tag(child.tag) && child.tag != "texture" && child.tag != "ref")
            continue;
        if (child.tag == "ref" && resolve_(child).tag != "texture")
            continue;
        if (found)
            diagnostics_.warn(child.location, "\"" + name + "\" is given twice; this one counts");
        found = &child;
        read_.insert(found);
    }
    return found;
}

SceneError Properties::error(const std::string &name, const std::string &message) {
    return SceneError(location_of(name), message);
}

Location Properties::location_of(const std::string &name) {
    const Element *property = find(name);
    return property ? property->location : element_.location;
}

const std::string &Properties::value_of(const Element &property) {
    const std::string name = property.attribute_or("name", "");
    if (!is_property_tag(property.tag) || property.tag == "transform")
        throw SceneError(property.location, "\"" + name + "\" cannot be a <" + property.tag + ">");
    const std::string *value = property.attribute("value");
    if (!value)
        throw SceneError(property.location, "<" + property.tag + " name=\"" + name + "\"> has no value");
    return *value;
}

bool Properties::has(const std::string &name) { return find(name) != nullptr; }

double Properties::number(const std::string &name, double otherwise, double lowest, double highest) {
    const Element *property = find(name);
    if (!property)
        return otherwise;
    const std::string &text = value_of(*property);
    const std::optional<double> value = parse_number(text);
    if (!value)
        throw SceneError(property->location, "\"" + name + "\" needs a number, not \"" + text + "\"");
    if (*value < lowest || *value > highest) {
        std::string range;
        const auto show = [](double bound) {
            std::string shown = std::to_string(bound);
            shown.erase(shown.find_last_not_of('0') + 1);
            if (shown.back() == '.')
                shown.pop_back();
            return shown;
        };
        if (std::isfinite(lowest))
            range += "at least " + show(lowest);
        if (std::isfinite(highest))
            range += (range.empty() ? "" : " and ") + ("at most " + show(highest));
        throw SceneError(property->location, "\"" + name + "\" is " + text + " but must be " + range);
    }
    return *value;
}

Number Properties::textured_number(const std::string &name, const Number &otherwise, double lowest, double highest,
                                   double least) {
    const Element *property = find(name);
    if (!property)
        return otherwise;
    const Element *texture = texture_of(*property);
    if (!texture)
        return float(std::max(least, number(name, otherwise, lowest, highest)));
    const FoundTexture found = (*read_texture_)(*texture, std::max(lowest, least), highest);
    Number result(float(*std::min_element(found.range.least.begin(), found.range.least.end())));
    result.texture = found.index;
    return result;
}

const Element *Properties::texture_of(const Element &property) {
    if (!read_texture_)
        return nullptr;
    const Element &target = property.tag == "ref" ? resolve_(property) : property;
    return target.tag == "texture" ? &target : nullptr;
}

std::int64_t Properties::integer(const std::string &name, std::int64_t otherwise, std::int64_t lowest,
                                 std::int64_t highest) {
    const Element *property = find(name);
    if (!property)
        return otherwise;
    const std::string &text = value_of(*property);
    const std::optional<std::int64_t> value = parse_integer(text);
    if (!value)
        throw SceneError(property->location, "\"" + name + "\" needs an integer, not \"" + text + "\"");
    if (*value < lowest || *value > highest)
        throw SceneError(property->location, "\"" + name + "\" is " + text + " but must be from " +
                                                 std::to_string(lowest) + " to " + std::to_string(highest));
    return *value;
}

bool Properties::boolean(const std::string &name, bool otherwise) {
    const Element *property = find(name);
    if (!property)
        return otherwise;
    const std::string &text = value_of(*property);
    const std::optional<bool> value = parse_boolean(text);
    if (!value)
        throw SceneError(property->location, "\"" + name + "\" needs true or false, not \"" + text + "\"");
    return *value;
}

std::string Properties::string(const std::string &name, const std::string &otherwise) {
    const Element *property = find(name);
    return property ? std::string(trimmed(value_of(*property))) : otherwise;
}

Double3 Properties::point(const std::string &name, const Double3 &otherwise) {
    const Element *property = find(name);
    if (!property)
        return otherwise;
    if (property->tag != "point" && property->tag != "vector")
        throw SceneError(property->location,
                         "\"" + name + "\" needs a <point> or <vector>, not a <" + property->tag + ">");
    if (property->attribute("value")) {
        const std::string &text = value_of(*property);
        const std::optional<std::vector<double>> values = parse_numbers(text);
        if (!values || values->size() != 3)
            throw SceneError(property->location, "\"" + name + "\" needs three numbers, not \"" + text + "\"");
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

Matrix4 Properties::transform(const std::string &name) {
    const Element *property = find(name);
    if (!property)
        return {};
    if (property->tag != "transform")
        throw SceneError(property->location, "\"" + name + "\" needs a <transform>, not a <" + property->tag + ">");
    return read_transform(*property, diagnostics_);
}

double Properties::refractive_index(const std::string &name, const std::string &otherwise) {
    const std::string text = string(name, otherwise);
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

std::vector<Properties::Object> Properties::objects(const std::string &tag) {
    std::vector<Object> found;
    for (const Element &child : element_.children) {
        const Element *target = child.tag == "ref" ? &resolve_(child) : &child;
        if (target->tag != tag)
            continue;
        read_.insert(&child);
        found.push_back({target, child.location});
    }
    return found;
}

void Properties::ignore(std::initializer_list<const char *> names) {
    for (const char *name : names)
        find(name);
}

void Properties::report_unread() {
    if (ignore_rest_)
        return;
    const std::string owner = element_.tag + (type().empty() ? "" : " \"" + type() + "\"");
    for (const Element &child : element_.children) {
        if (read_.count(&child))
            continue;
        const std::string *written = child.attribute("name");
        if (is_property_tag(child.tag) || (child.tag == "texture" && written)) {
            const std::string name = snake_case(trimmed(written ? *written : ""));
            std::string message = "unknown parameter \"" + (written ? *written : "") + "\" of " + owner + " is ignored";
            if (const auto nearest = diagnostics_.is_full() ? std::nullopt : nearest_name(name, asked_))
                message += "; did you mean \"" + *nearest + "\"?";
            diagnostics_.unknown(child.location, message);
        } else if (child.tag == "ref")
            diagnostics_.unknown(child.location,
                                 "<ref id=\"" + child.attribute_or("id", "") + "\"> in " + owner + " is not used");
        else
            diagnostics_.unknown(child.location, "<" + child.tag + "> in " + owner + " is not used");
    }
}

} // namespace gradus
