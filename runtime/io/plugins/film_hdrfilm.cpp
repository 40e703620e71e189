// <film type="hdrfilm">: the size of the image and its reconstruction filter.
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

namespace gradus {

Declaration declare_film_hdrfilm() {
    return {
        "the size of the image and its reconstruction filter",
        joined({{Parameter{"width", Takes::integer, "768", "of the film"}.in("pixels").at_least(1).at_most(0x7fffffff),
                 Parameter{"height", Takes::integer, "576", "of the film"}.in("pixels").at_least(1).at_most(0x7fffffff),
                 Parameter{"crop_offset_x", Takes::integer, "0", "the part of the film that is the image"}.in("pixels"),
                 Parameter{"crop_offset_y", Takes::integer, "0", ""}.in("pixels"),
                 Parameter{"crop_width", Takes::integer, nullptr, ""}.in("pixels").or_else("the rest"),
                 Parameter{"crop_height", Takes::integer, nullptr, ""}.in("pixels").or_else("the rest"),
                 {"rfilter", Takes::objects, nullptr,
                  "one, or a Gaussian. Pixels at the border take what lies beyond it, and a crop is what it is in the "
                  "whole image, as Mitsuba has it with sample_border"}},
                meaningless({"sample_border", "filename", "file_format", "pixel_format", "component_format",
                             "channel_names", "banner", "attach_log", "high_quality_edges", "compensate", "exposure",
                             "gamma", "tonemap_method"})})};
}

namespace {

/// Mitsuba's image is then gray or of other primaries.
void warn_of_pixel_format(Properties &properties) {
    const std::string format = properties.written("pixel_format");
    for (const std::string_view part : split_list(format))
        if (const std::string name = lower_case(part); name != "rgb" && name != "rgba") {
            properties.diagnostics().warn(properties.location_of("pixel_format"),
                                          "pixel_format " + quoted_excerpt(format) +
                                              " has no effect here: images are red, green and blue");
            return;
        }
}

} // namespace

FilmSettings film_hdrfilm(Properties &properties, SceneBuilder &builder) {
    FilmSettings film;
    constexpr std::int64_t most = 0x7fffffff;
    warn_of_pixel_format(properties);
    film.width = std::uint32_t(properties.integer("width"));
    film.height = std::uint32_t(properties.integer("height"));
    if (std::int64_t(film.width) * film.height > most)
        throw properties.error("width", "a film of " + std::to_string(film.width) + " x " +
                                            std::to_string(film.height) + " has more than 2^31 - 1 pixels");
    const bool is_cropped = properties.has("crop_offset_x") || properties.has("crop_offset_y") ||
                            properties.has("crop_width") || properties.has("crop_height");
    if (is_cropped) {
        film.crop_x = std::uint32_t(properties.integer("crop_offset_x", 0, film.width - 1));
        film.crop_y = std::uint32_t(properties.integer("crop_offset_y", 0, film.height - 1));
        const std::uint32_t wide = film.width - film.crop_x, high = film.height - film.crop_y;
        film.crop_width =
            properties.has("crop_width") ? std::uint32_t(properties.integer("crop_width", 1, wide)) : wide;
        film.crop_height =
            properties.has("crop_height") ? std::uint32_t(properties.integer("crop_height", 1, high)) : high;
    }
    if (const Element *const its_filter = the_one_of(properties.objects("rfilter"), properties.diagnostics())) {
        const Element &element = *its_filter;
        const std::string type = element.attribute_or("type", "");
        ReconstructionFilter filter; // a Gaussian
        if (type.empty() || find_plugin<ReconstructionFilter>(std::string(trimmed(type))))
            filter = builder.build_object<ReconstructionFilter>(element);
        else
            properties.diagnostics().warn(element.location, "the filter \"" + type +
                                                                "\" is not known here; gaussian takes its place "
                                                                "(known: " +
                                                                join(plugin_names("rfilter")) + ")");
        film.filter = filter.filter;
        film.filter_radius = filter.radius;
        film.filter_stddev = filter.stddev;
        film.mitchell_b = filter.b;
        film.mitchell_c = filter.c;
    }
    return film;
}

} // namespace gradus
