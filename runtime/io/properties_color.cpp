// Colours among the properties: <rgb>, <srgb>, <spectrum>, <blackbody> and plain numbers.
#include "runtime/io/file_search.h"
#include "runtime/io/properties.h"
#include "runtime/io/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace gradus {

namespace {

Rgb gray(double value) { return {float(value), float(value), float(value)}; }

/// "#rrggbb" as three numbers in [0, 1].
std::optional<Double3> parse_hex_color(std::string_view text) {
    text = trimmed(text);
    if (text.size() != 7 || text[0] != '#')
        return std::nullopt;
    Double3 color;
    for (int i = 0; i < 3; ++i) {
        unsigned value = 0;
        const char *begin = text.data() + 1 + 2 * i;
        const auto [end, error] = std::from_chars(begin, begin + 2, value, 16);
        if (error != std::errc() || end != begin + 2)
            return std::nullopt;
        color[i] = value / 255.0;
    }
    return color;
}

/// "400:0.1, 500:0.2": pairs of wavelength and value.
SampledSpectrum parse_samples(const Element &property, const std::string &text) {
    SampledSpectrum samples;
    // A blank after the colon is allowed: join such pairs first.
    std::string joined;
    for (std::size_t i = 0; i < text.size(); ++i) {
        joined += text[i];
        if (text[i] == ':')
            while (i + 1 < text.size() && text[i + 1] == ' ')
                ++i;
    }
    for (std::string_view item : split_list(joined)) {
        const std::size_t colon = item.find(':');
        const std::optional<double> wavelength = parse_number(item.substr(0, colon));
        const std::optional<double> value =
            colon == std::string_view::npos ? std::nullopt : parse_number(item.substr(colon + 1));
        if (!wavelength || !value)
            throw SceneError(property.location, "\"" + std::string(item) + "\" is no pair wavelength:value");
        if (!samples.empty() && *wavelength <= samples.back().first)
            throw SceneError(property.location,
                             "the wavelengths of a spectrum must rise; " + std::string(item) + " does not");
        samples.emplace_back(*wavelength, *value);
    }
    return samples;
}

Rgb to_rgb(const Double3 &c) { return {float(c[0]), float(c[1]), float(c[2])}; }

} // namespace

Rgb Properties::read_spectrum(const Element &property, const std::string &name, ColorUse use) {
    const std::string &text = value_of(property);
    if (text.find(':') != std::string::npos) {
        const SampledSpectrum samples = parse_samples(property, text);
        for (const auto &[wavelength, value] : samples)
            if (value < 0)
                throw SceneError(property.location,
                                 "\"" + name + "\" is negative at " + std::to_string(wavelength) + " nm");
        const Rgb rgb = spectrum_to_rgb(samples, use);
        if (use == ColorUse::reflectance) // a saturated colour may leave the unit cube though no sample does
            return {std::min(rgb.r, 1.0f), std::min(rgb.g, 1.0f), std::min(rgb.b, 1.0f)};
        return rgb;
    }
    const std::optional<std::vector<double>> values = parse_numbers(text);
    if (!values || (values->size() != 1 && values->size() != 3))
        throw SceneError(property.location, "\"" + name +
                                                "\" needs one number, three (RGB), or wavelength:value pairs," +
                                                " not \"" + text + "\"");
    if (values->size() == 3)
        return {float((*values)[0]), float((*values)[1]), float((*values)[2])};
    if (use != ColorUse::emission || element_.is_legacy()) // of 0.x the same in all channels, a light's too
        return gray((*values)[0]);
    const Rgb tint = spectrum_to_rgb({{0, 1.0}, {1e6, 1.0}}, use); // of equal energy at all wavelengths
    return {float(tint.r * (*values)[0]), float(tint.g * (*values)[0]), float(tint.b * (*values)[0])};
}

/// <blackbody temperature="5000K" scale="1"/>, of 0.x.
Rgb Properties::read_black_body(const Element &property, const std::string &name, ColorUse use) {
    std::string text(trimmed(property.attribute_or("temperature", "")));
    if (!text.empty() && (text.back() == 'K' || text.back() == 'k'))
        text.pop_back();
    const std::optional<double> temperature = parse_number(text),
                                factor = parse_number(property.attribute_or("scale", "1"));
    if (!temperature || *temperature < least_temperature || *temperature > most_temperature || !factor || *factor < 0)
        throw SceneError(property.location, "\"" + name +
                                                "\": a <blackbody> has a temperature from 1 to 1e9 kelvins, as in "
                                                "temperature=\"5000K\", and may have a scale of at least 0");
    const Rgb rgb = spectrum_to_rgb(black_body_spectrum(*temperature), use);
    const auto by = float(*factor);
    return {rgb.r * by, rgb.g * by, rgb.b * by};
}

Double3 Properties::read_rgb(const std::string &text, const Parameter &parameter, const Location &location) {
    if (const std::optional<Double3> hex = parse_hex_color(text))
        return *hex;
    const std::optional<std::vector<double>> values = parse_numbers(text);
    if (!values || (values->size() != 1 && values->size() != 3))
        throw SceneError(location,
                         "\"" + parameter.name + "\" needs one or three numbers or #rrggbb, not \"" + text + "\"");
    Double3 color;
    for (int i = 0; i < 3; ++i)
        color[i] = (*values)[values->size() == 3 ? i : 0];
    return color;
}

Rgb Properties::read_color(const Element &property, const Parameter &parameter, ColorUse use) {
    const std::string &name = parameter.name;
    if (const Element *texture = texture_of(property)) {
        const Color color = color_of_texture(*texture, std::numeric_limits<float>::max());
        if (color.texture != no_texture)
            throw SceneError(property.location, "\"" + name + "\" cannot be a texture; give it as <rgb> or <spectrum>");
        return color;
    }
    if (property.tag == "spectrum")
        return read_spectrum(property, name, use);
    if (property.tag == "blackbody")
        return read_black_body(property, name, use);
    const bool gamma_coded = property.tag == "srgb";
    if (property.tag != "rgb" && !gamma_coded && property.tag != "float" && property.tag != "integer")
        throw SceneError(property.location,
                         "\"" + name + "\" needs a colour (<rgb>, <srgb>, <spectrum>, <blackbody> or <float>)," +
                             " not a <" + property.tag + ">");
    Double3 color = read_rgb(value_of(property), parameter, property.location);
    if (gamma_coded)
        for (double &value : color)
            value = value < 0 ? value : srgb_to_linear_value(value);
    return to_rgb(color);
}

Color Properties::color_of_texture(const Element &texture, double highest) {
    const FoundTexture found = (*read_texture_)(texture, 0, highest, StandsFor::color);
    Color color(float(found.range.mean[0]), float(found.range.mean[1]), float(found.range.mean[2]));
    color.texture = found.index;
    return color;
}

Color Properties::color(const std::string &name) {
    const Color color = color_as_written(name);
    const float most = std::max({color.r, color.g, color.b});
    if (declared(name, {}).takes != Takes::reflectance || most <= 1)
        return color;
    const bool keeps_hue = element_.is_legacy(); // as Mitsuba 0.6 does it
    diagnostics_.warn(location_of(name), "\"" + name + "\" is above 1, which would create energy; " +
                                             (keeps_hue ? "scaled to 0.99" : "clamped to 1"));
    if (keeps_hue)
        return {0.99f * (color.r / most), 0.99f * (color.g / most), 0.99f * (color.b / most)};
    return {std::min(color.r, 1.0f), std::min(color.g, 1.0f), std::min(color.b, 1.0f)};
}

Color Properties::color_as_written(const std::string &name) {
    const Parameter &parameter = declared(
        name, {Takes::reflectance, Takes::emission, Takes::textured_emission, Takes::color, Takes::signed_color});
    const bool reflects = parameter.takes == Takes::reflectance;
    const Element *property = find(parameter);
    if (!property)
        return to_rgb(read_rgb(text_of(parameter, nullptr), parameter, element_.location));
    if (reflects || parameter.takes == Takes::textured_emission)
        if (const Element *texture = texture_of(*property))
            return color_of_texture(*texture, reflects ? 1 : std::numeric_limits<float>::max());
    const bool shines = parameter.takes == Takes::emission || parameter.takes == Takes::textured_emission;
    const ColorUse use = reflects ? ColorUse::reflectance : shines ? ColorUse::emission : ColorUse::index;
    const Color color = read_color(*property, parameter, use);
    for (float value : {color.r, color.g, color.b}) {
        if (value < 0 && parameter.takes != Takes::signed_color)
            throw SceneError(property->location, "\"" + name + "\" must not be negative");
        if (!std::isfinite(value))
            throw SceneError(property->location, "\"" + name + "\" is too large for single precision");
    }
    return color;
}

} // namespace gradus
