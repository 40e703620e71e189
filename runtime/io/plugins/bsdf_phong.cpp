// <bsdf type="phong">, of Mitsuba 0.x: a lobe around the mirror direction beside a diffuse one.
//   diffuse_reflectance (0.5), specular_reflectance (0.2), exponent (30)
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Material bsdf_phong(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::phong;
    read_two_lobes(properties, bsdf);
    bsdf.exponent = properties.textured_number("exponent", 30.0f, 0, 1e30, 0);
    // Of Beckmann's microfacets whose lobe is as wide.
    bsdf.alpha_u = bsdf.alpha_v = std::sqrt(2 / (bsdf.exponent + 2));
    return material;
}

} // namespace gradus
