#include "driver/plugin_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

constexpr double no_bound = 1e12; ///< what is that large is there for the arithmetic alone

std::string code(const std::string &text) { return "`" + text + "`"; }

/// Items in code style, with commas.
std::string listed(const std::vector<std::string> &items) {
    std::string text;
    for (const std::string &item : items)
        text += (text.empty() ? "" : ", ") + code(item);
    return text;
}

std::string type_text(const Parameter &parameter) {
    switch (parameter.takes) {
    case Takes::number:
        return "number";
    case Takes::integer:
        return "integer";
    case Takes::boolean:
        return "boolean";
    case Takes::string:
        return "string";
    case Takes::filename:
        return "file name";
    case Takes::choice:
        return listed(parameter.words);
    case Takes::point:
        return "point or vector";
    case Takes::transform:
        return "transform";
    case Takes::reflectance:
        return "colour or texture, 0 to 1";
    case Takes::emission:
        return "colour";
    case Takes::textured_emission:
        return "colour or texture";
    case Takes::color:
        return "colour";
    case Takes::signed_color:
        return "colour, of either sign";
    case Takes::textured_number:
        return "number or texture";
    case Takes::refractive_index:
        return "number or material's name";
    case Takes::objects:
        return "nested, or by `<ref>`";
    case Takes::nothing:
        break;
    }
    return "";
}

std::string takes_text(const Parameter &parameter) {
    std::string text = type_text(parameter);
    const bool has_lowest = parameter.lowest > -no_bound, has_highest = parameter.highest < no_bound;
    if (has_lowest && has_highest)
        text += fmt::format(", {} to {}", parameter.lowest, parameter.highest);
    else if (has_lowest)
        text += fmt::format(", at least {}", parameter.lowest);
    return text + (*parameter.unit ? fmt::format(", {}", parameter.unit) : "");
}

std::string default_text(const Parameter &parameter) {
    if (parameter.is_required)
        return "needed";
    std::string text = parameter.takes == Takes::transform ? "the identity" : parameter.without;
    if (parameter.like)
        text = code(parameter.like);
    if (parameter.otherwise)
        text = parameter.otherwise;
    if (parameter.otherwise_before_2)
        text += fmt::format("; 0.x: {}", parameter.otherwise_before_2);
    return text;
}

std::string row(const std::string &plugin, const std::string &parameter, const std::string &takes,
                const std::string &otherwise, const std::string &about) {
    return fmt::format("| {} | {} | {} | {} | {} |\n", plugin, parameter, takes, otherwise, about);
}

std::string rows(const CataloguedPlugin &plugin) {
    std::string text = row(code(plugin.name), "", "", "", plugin.declaration.about);
    std::vector<std::string> meaningless;
    for (const Parameter &parameter : plugin.declaration.parameters) {
        if (parameter.takes == Takes::nothing) {
            meaningless.push_back(parameter.name);
            continue;
        }
        std::string name = code(parameter.takes == Takes::objects ? "<" + parameter.name + ">" : parameter.name);
        if (parameter.also_named)
            name += ", " + code(parameter.also_named);
        if (parameter.is_of_before_2)
            name += " (0.x)";
        text += row("", name, takes_text(parameter), default_text(parameter), parameter.about);
    }
    if (!meaningless.empty())
        text += row("", listed(meaningless), "anything", "", "no meaning here");
    return text;
}

} // namespace

std::string plugin_tables(const std::vector<CataloguedPlugin> &catalogue, const std::vector<std::string> &names) {
    struct Category {
        const char *tag, *title;
    };
    constexpr Category categories[] = {
        {"integrator", "Integrators"}, {"sensor", "Sensors"}, {"film", "Films"}, {"rfilter", "Filters"},
        {"sampler", "Samplers"},       {"shape", "Shapes"},   {"bsdf", "BSDFs"}, {"texture", "Textures"},
        {"emitter", "Emitters"}};
    std::string text;
    for (const Category &category : categories) {
        std::string table;
        for (const CataloguedPlugin &plugin : catalogue)
            if (plugin.category == category.tag && (names.empty() || std::ranges::count(names, plugin.name) > 0))
                table += rows(plugin);
        if (table.empty())
            continue;
        text += fmt::format("{}### {}: `<{}>`\n\n", text.empty() ? "" : "\n", category.title, category.tag);
        text += "| plugin | parameter | takes | default | |\n|---|---|---|---|---|\n" + table;
    }
    return text;
}

} // namespace gradus
