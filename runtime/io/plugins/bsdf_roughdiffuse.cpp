// <bsdf type="roughdiffuse">, of Mitsuba 0.x: a surface of diffuse facets.
//   reflectance (0.5), alpha (0.2), use_fast_approx (false)
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_roughdiffuse(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::roughdiffuse;
    const Color other = properties.color("diffuse_reflectance", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    material.front.reflectance = properties.color("reflectance", other, ColorUse::reflectance);
    material.front.facet_alpha = properties.textured_number("alpha", 0.2f, 0, 1e30, 0);
    material.front.fast_approximation = properties.boolean("use_fast_approx", false) ? 1.0f : 0.0f;
    return material;
}

} // namespace gradus
