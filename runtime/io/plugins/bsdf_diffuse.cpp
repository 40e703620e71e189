// <bsdf type="diffuse">: Lambertian reflection.
//   reflectance (diffuseReflectance in 0.x)  albedo, 0.5
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_diffuse(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::diffuse;
    const Rgb legacy = properties.color("diffuse_reflectance", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    material.front.reflectance = properties.color("reflectance", legacy, ColorUse::reflectance);
    return material;
}

} // namespace gradus
