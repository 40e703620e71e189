// <emitter type="envmap">: light from every direction, by an image in latitude and longitude.
//   filename  EXR, HDR, PNG, JPEG and what else OpenImageIO reads, linear or decoded to it; W sr^-1 m^-2
//   scale  1 (0.x: also intensity_scale); to_world  rotations and mirrors, of which a size does not count
#include "runtime/io/environment_file.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Emitter emitter_envmap(Properties &properties, SceneBuilder &builder) {
    Emitter emitter;
    emitter.kind = Emitter::Kind::environment;
    const auto scale = float(properties.number("scale", properties.number("intensity_scale", 1, 0, 1e30), 0, 1e30));
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
    properties.ignore({"sampling_weight", "mis_compensation", "scale_bsphere", "cache", "gamma"});
    emitter.map = read_environment(builder.find_file(properties), builder.limits().images,
                                   properties.location_of("filename"), builder.diagnostics());
    const Rgb all = emitter.map->integral;
    if (all.r > 0 || all.g > 0 || all.b > 0) // a black one is no light
        emitter.value = {scale, scale, scale};
    return emitter;
}

} // namespace gradus
