// <film type="hdrfilm">: the size of the image and its reconstruction filter.
//   width (768), height (576); crop_offset_x, crop_offset_y, crop_width, crop_height; a nested rfilter (gaussian)
#include "runtime/io/plugins/plugin.h"
#include "runtime/io/text.h"

namespace gradus {

FilmSettings film_hdrfilm(Properties &properties, SceneBuilder &builder) {
    FilmSettings film;
    constexpr std::int64_t most = 0x7fffffff;
    film.width = std::uint32_t(properties.integer("width", 768, 1, most));
    film.height = std::uint32_t(properties.integer("height", 576, 1, most));
    if (std::int64_t(film.width) * film.height > most)
        throw properties.error("width", "a film of " + std::to_string(film.width) + " x " +
                                            std::to_string(film.height) + " has more than 2^31 - 1 pixels");
    const bool is_cropped = properties.has("crop_offset_x") || properties.has("crop_offset_y") ||
                            properties.has("crop_width") || properties.has("crop_height");
    if (is_cropped) {
        film.crop_x = std::uint32_t(properties.integer("crop_offset_x", 0, 0, film.width - 1));
        film.crop_y = std::uint32_t(properties.integer("crop_offset_y", 0, 0, film.height - 1));
        film.crop_width =
            std::uint32_t(properties.integer("crop_width", film.width - film.crop_x, 1, film.width - film.crop_x));
        film.crop_height =
            std::uint32_t(properties.integer("crop_height", film.height - film.crop_y, 1, film.height - film.crop_y));
    }
    if (const auto filters = properties.objects("rfilter"); !filters.empty()) {
        const Element &element = *filters.front().element;
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
    properties.ignore({"file_format", "pixel_format", "component_format", "banner", "attach_log", "high_quality_edges",
                       "sample_border", "compensate", "exposure", "gamma", "tonemap_method"});
    return film;
}

} // namespace gradus
