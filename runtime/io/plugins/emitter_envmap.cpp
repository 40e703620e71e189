// <emitter type="envmap">: light from every direction, by an image in latitude and longitude.
#include "runtime/io/environment_file.h"
#include "runtime/io/plugins/parameters_of_emitters.h"
#include "runtime/io/plugins/parameters_of_textures.h"
#include "runtime/io/plugins/plugin.h"
#include "runtime/phases.h"

#include <cmath>

namespace gradus {

Declaration declare_emitter_envmap() {
    return {
        "light from every direction, by an image in latitude and longitude. Values are kept to 11 bits, so half floats "
        "and RGBE exactly; negative ones and those that are no number count as 0, infinite ones and those above 1e30 "
        "as the largest, with a "
        "warning",
        joined(
            {{Parameter{"filename", Takes::filename, nullptr,
                        "EXR, HDR, PNG, JPEG and what else OpenImageIO reads, of any size; 8 and 16 bits are decoded "
                        "from sRGB. Its R, G and B, or those of its first layer that has them, or its Y"}
                  .required(),
              parameter_gamma().or_else("sRGB"),
              Parameter{"scale", Takes::number, "1", "what the image is times"}
                  .also("intensity_scale")
                  .at_least(0)
                  .at_most(1e30),
              {"to_world", Takes::transform, nullptr, "turned and mirrored, not stretched; a size does not count"}},
             meaningless({"sampling_weight", "mis_compensation", "scale_bsphere", "cache"})})};
}

Emitter emitter_envmap(Properties &properties, SceneBuilder &builder) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::environment;
    const auto scale = float(properties.number("scale"));
    const std::optional<TurnedAxes> turned = turned_axes(properties.transform("to_world"));
    if (!turned)
        throw properties.error("to_world", "an environment map can be turned and mirrored, not stretched");
    for (std::size_t axis = 0; axis < 3; ++axis)
        emitter.axes[axis] = to_float(turned->axes[axis]);
    const Phase phase(builder.phases(), phase_names::pictures);
    const Location location = properties.location_of("filename");
    emitter.map = read_environment(*builder.open_file(builder.find_file(properties), location), builder.limits().images,
                                   location, builder.diagnostics(),
                                   is_linear_by_gamma(properties, false) ? WholeNumbers::linear : WholeNumbers::srgb);
    const Rgb all = emitter.map->integral;
    if (!std::isfinite(scale * all.r + scale * all.g + scale * all.b))
        throw properties.error("scale", "the environment is too bright for single precision");
    if (all.r > 0 || all.g > 0 || all.b > 0) // a black one is no light
        emitter.value = {scale, scale, scale};
    return emitter;
}

} // namespace gradus
