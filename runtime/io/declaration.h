// What a plugin of scene files says of itself: its parameters, with types, defaults and meanings. Properties reads
// files by it, tests take their cases from it, and `gradus plugins` prints it.
#pragma once

#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace gradus {

/// What stands for a parameter in a file.
enum class Takes {
    number,
    integer,
    boolean,
    string,
    filename,
    choice, ///< one of a few words, upper and lower case alike
    point,
    transform,
    reflectance,       ///< a colour from 0 to 1, or a texture
    emission,          ///< a colour of at least 0, a light's
    textured_emission, ///< the same, or a texture
    color,             ///< a colour of at least 0, of neither a surface nor a light: an index, or within a texture
    signed_color,      ///< the same, and less than 0
    textured_number,   ///< a number, or a texture
    refractive_index,  ///< a number, or the name of a material
    objects,           ///< nested objects; the parameter's name is their tag
    nothing            ///< it may be there and has no meaning for this program
};

/// A parameter, by its snake_case name. Its default is text as a file would have it, and is read as a file's text is.
struct Parameter {
    std::string name;
    Takes takes = Takes::nothing;
    const char *otherwise = nullptr; ///< the default; nullptr: there is none
    std::string about = {};          ///< what it is
    const char *unit = "";
    const char *otherwise_before_2 = nullptr; ///< the default in files of version 0.x, where it is another one
    const char *like = nullptr;               ///< without a default: the parameter whose value counts then
    const char *also_named = nullptr;         ///< counts where there is none of the first name
    const char *without = "";                 ///< what happens without it, for readers, where there is no default
    bool is_required = false;
    bool is_of_before_2 = false; ///< known from files of version 0.x; it is read in all
    double lowest = -std::numeric_limits<double>::infinity(), highest = std::numeric_limits<double>::infinity();
    double least = -std::numeric_limits<double>::infinity(); ///< smaller ones count as this
    std::vector<std::string> words = {};                     ///< of a choice

    Parameter in(const char *its_unit) const { return with(&Parameter::unit, its_unit); }
    Parameter before_2(const char *its_default) const { return with(&Parameter::otherwise_before_2, its_default); }
    Parameter as(const char *other) const { return with(&Parameter::like, other); }
    Parameter also(const char *other) const { return with(&Parameter::also_named, other); }
    Parameter or_else(const char *text) const { return with(&Parameter::without, text); }
    Parameter required() const { return with(&Parameter::is_required, true); }
    Parameter of_before_2() const { return with(&Parameter::is_of_before_2, true); }
    Parameter at_least(double bound) const { return with(&Parameter::lowest, bound); }
    Parameter at_most(double bound) const { return with(&Parameter::highest, bound); }
    Parameter raised_to(double bound) const { return with(&Parameter::least, bound); }
    Parameter of(std::vector<std::string> choices) const { return with(&Parameter::words, std::move(choices)); }

  private:
    template <typename Value>
    Parameter with(Value Parameter::*member, Value value) const {
        Parameter changed = *this;
        changed.*member = std::move(value);
        return changed;
    }
};

using ParameterList = std::vector<Parameter>;
/// One list after the other.
ParameterList joined(std::initializer_list<ParameterList> lists);
/// Parameters without a meaning.
ParameterList meaningless(std::initializer_list<const char *> names);

struct Declaration {
    std::string about;
    ParameterList parameters;

    /// nullptr where there is none of that name, or nested objects of that tag. `also_named` is not looked at.
    const Parameter *find(const std::string &name) const;
    const Parameter *find_objects(const std::string &tag) const;
};

} // namespace gradus
