// <emitter type="envmap">: light from every direction, by an image in latitude and longitude.
#include "runtime/io/environment_file.h"
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
        joined({{Parameter{"filename", Takes::filename, nullptr,
                           "EXR, HDR, PNG, JPEG and what else OpenImageIO reads, of any size; 8 bits are decoded from "
                           "sRGB. Its R, G and B, or its first channel"}
                     .required(),
                 Parameter{"scale", Takes::number, "1", "what the image is times"}
                     .also("intensity_scale")
                     .at_least(0)
                     .at_most(1e30),
                 {"to_world", Takes::transform, nullptr, "turned and mirrored, not stretched; a size does not count"}},
                meaningless({"sampling_weight", "mis_compensation", "scale_bsphere", "cache", "gamma"})})};
}

Emitter emitter_envmap(Properties &properties, SceneBuilder &builder) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::environment;
    const auto scale = float(properties.number("scale"));
    const Matrix4 to_world = properties.transform("to_world");
    std::array<Double3, 3> axes;
    for (int axis = 0; axis < 3; ++axis) {
        Double3 unit{};
        unit[std::size_t(axis)] = 1;
        axes[std::size_t(axis)] = transform_vector(to_world, unit);
    }
    const double size = length(axes[0]);
    for (std::size_t a = 0; a < 3; ++a) {
        const Double3 &next = axes[(a + 1) % 3];
        if (!(size > 0) || std::fabs(dot(axes[a], next)) > 1e-4 * size * size ||
            std::fabs(length(axes[a]) - size) > 1e-4 * size)
            throw properties.error("to_world", "an environment map can be turned and mirrored, not stretched");
        emitter.axes[a] = to_float(normalize(axes[a]));
    }
    const Phase phase(builder.phases(), phase_names::pictures);
    const Location location = properties.location_of("filename");
    emitter.map = read_environment(*builder.open_file(builder.find_file(properties), location), builder.limits().images,
                                   location, builder.diagnostics());
    const Rgb all = emitter.map->integral;
    if (!std::isfinite(scale * all.r + scale * all.g + scale * all.b))
        throw properties.error("scale", "the environment is too bright for single precision");
    if (all.r > 0 || all.g > 0 || all.b > 0) // a black one is no light
        emitter.value = {scale, scale, scale};
    return emitter;
}

} // namespace gradus
