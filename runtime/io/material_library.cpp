#include "runtime/io/material_library.h"

#include "runtime/io/diagnostics.h"
#include "runtime/io/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace gradus {

namespace {

constexpr std::string_view blanks = " \t\r";

/// Takes the next word off a line; empty at its end.
std::string_view next_word(std::string_view &line) {
    line = trimmed(line);
    const std::string_view word = line.substr(0, line.find_first_of(blanks));
    line.remove_prefix(word.size());
    return word;
}

/// How many words may follow an option of a texture.
std::size_t arguments_of(std::string_view option) {
    if (option == "-o" || option == "-s" || option == "-t")
        return 3;
    return option == "-mm" ? 2 : 1;
}

using Channels = std::array<double, 3>; ///< red, green and blue, from 0 to 1

/// A material of which all lines so far have been read.
struct LinesOfMaterial {
    std::string name;
    Location location;
    Element diffuse, specular; ///< colours or textures, without a name
    double exponent = 0;
    std::optional<Element> bump, mask;
    int model = 0;
    bool is_specular = false; ///< not black
};

class MtlReader {
  public:
    MtlReader(const std::string &text, const std::string &file_name,
              const std::function<bool(const std::string &)> &is_there)
        : text_(text), file_(std::make_shared<const std::string>(file_name)), is_there_(is_there) {}

    MaterialLibrary read() {
        for (std::string_view rest = std::string_view(text_).substr(byte_order_mark(text_).size()); !rest.empty();) {
            ++line_;
            read_line(take_line(rest));
        }
        add_material();
        return std::move(library_);
    }

  private:
    Location here() const { return {file_, line_}; }
    [[noreturn]] void fail(const std::string &message) const { throw SceneError(here(), message); }

    /// Elements as of a file of version 0.x.
    Element element(const std::string &tag, std::vector<std::pair<std::string, std::string>> attributes) const {
        return {tag, std::move(attributes), {}, here(), 0};
    }
    Element object(const std::string &tag, const std::string &type, std::vector<Element> children) const {
        Element made = element(tag, {{"type", type}});
        made.children = std::move(children);
        return made;
    }
    Element property(const std::string &tag, const std::string &name, const std::string &value) const {
        return element(tag, {{"name", name}, {"value", value}});
    }
    static Element named(Element value, const std::string &name) {
        value.attributes.push_back({"name", name});
        return value;
    }

    double number(std::string_view &rest, std::string_view word) const {
        const auto value = parse_number(next_word(rest));
        if (!value)
            fail(std::string(word) + " needs a number");
        return *value;
    }

    /// Three channels, or one for all of them.
    Channels channels(std::string_view rest, std::string_view word) const {
        Channels rgb{};
        std::size_t count = 0;
        for (std::string_view text; count < 3 && !(text = next_word(rest)).empty(); ++count) {
            const auto value = parse_number(text);
            if (!value) {
                count = 0;
                break;
            }
            rgb[count] = std::clamp(*value, 0.0, 1.0);
        }
        if (count != 1 && count != 3)
            fail(std::string(word) + " needs three numbers: red, green and blue");
        return count == 3 ? rgb : Channels{rgb[0], rgb[0], rgb[0]};
    }
    Element color(const Channels &rgb) const {
        return element("srgb", {{"value", fmt::format("{}, {}, {}", rgb[0], rgb[1], rgb[2])}});
    }

    Element texture(std::string_view rest, std::string_view word) {
        rest = trimmed(rest);
        while (rest.starts_with('-')) {
            const std::string_view option = next_word(rest);
            library_.texture_options.insert(std::string(option));
            for (std::size_t i = 0; i < arguments_of(option); ++i) {
                std::string_view after = rest;
                const std::string_view argument = next_word(after);
                if (i > 0 && !parse_number(argument)) // the second and the third may be missing
                    break;
                rest = after;
            }
            rest = trimmed(rest);
        }
        if (rest.empty())
            fail(std::string(word) + " needs a file's name");
        if (rest.size() > 2 && rest.front() == '"' && rest.back() == '"')
            rest = rest.substr(1, rest.size() - 2);
        std::string name(rest);
        const std::size_t folders = name.find_last_of("/\\");
        if (folders != std::string::npos && !is_there_(name) && is_there_(name.substr(folders + 1)))
            name.erase(0, folders + 1);
        return object("texture", "bitmap", {property("string", "filename", name)});
    }

    void begin_material(std::string_view name) {
        add_material();
        now_.emplace();
        now_->name = trimmed(name);
        now_->location = here();
        now_->diffuse = now_->specular = color({});
    }

    void read_line(std::string_view line) {
        const std::string_view word = next_word(line);
        if (word == "newmtl")
            return begin_material(line);
        if (!now_)
            return;
        LinesOfMaterial &material = *now_;
        if (word == "Kd") {
            material.diffuse = color(channels(line, word));
        } else if (word == "map_Kd") {
            material.diffuse = texture(line, word);
        } else if (word == "Ks") {
            const Channels rgb = channels(line, word);
            material.specular = color(rgb);
            material.is_specular = rgb != Channels{};
        } else if (word == "map_Ks") {
            material.specular = texture(line, word);
            material.is_specular = true;
        } else if (word == "Ns") {
            material.exponent = std::max(number(line, word), 0.0);
        } else if (word == "illum") {
            material.model = int(std::clamp(number(line, word), 0.0, 100.0));
        } else if (word == "d") {
            if (std::string_view after = line; next_word(after) == "-halo") // fainter where it is seen from the side
                line = after;
            const double opacity = std::clamp(number(line, word), 0.0, 1.0);
            material.mask.reset();
            if (opacity < 1)
                material.mask = element("float", {{"value", fmt::format("{}", opacity)}});
        } else if (word == "map_d") {
            material.mask = texture(line, word);
        } else if (word == "bump") {
            material.bump = texture(line, word);
            material.bump->children.push_back(property("float", "gamma", "1"));
        }
    }

    /// The one that was begun.
    void add_material() {
        if (!now_)
            return;
        const LinesOfMaterial &material = *now_;
        const auto bsdf = [&](const char *type, std::vector<Element> children) {
            Element made = object("bsdf", type, std::move(children));
            made.location = material.location;
            return made;
        };
        const int model = material.model;
        Element made;
        if (model == 2 && material.is_specular && material.exponent > 0)
            made = bsdf("phong",
                        {named(material.diffuse, "diffuseReflectance"), named(material.specular, "specularReflectance"),
                         property("float", "exponent", fmt::format("{}", material.exponent))});
        else if (model == 4 || model == 6 || model == 7 || model == 9)
            made = bsdf("dielectric", {});
        else if (model == 5 || model == 8)
            made = bsdf("conductor", {property("string", "material", "Al")});
        else
            made = bsdf("diffuse", {named(material.diffuse, "reflectance")});
        if (material.bump)
            made = bsdf("bumpmap", {*material.bump, std::move(made)});
        if (material.mask)
            made = bsdf("mask", {named(*material.mask, "opacity"), std::move(made)});
        library_.bsdfs.insert_or_assign(material.name, std::move(made));
    }

    const std::string &text_;
    const std::shared_ptr<const std::string> file_;
    const std::function<bool(const std::string &)> &is_there_;
    std::size_t line_ = 0;
    std::optional<LinesOfMaterial> now_;
    MaterialLibrary library_;
};

} // namespace

MaterialLibrary parse_mtl(const std::string &text, const std::string &file_name,
                          const std::function<bool(const std::string &)> &is_there) {
    return MtlReader(text, file_name, is_there).read();
}

} // namespace gradus
