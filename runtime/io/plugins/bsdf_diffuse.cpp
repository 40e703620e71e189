// <bsdf type="diffuse">: Lambertian reflection.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_diffuse() {
    return {"Lambertian reflection",
            {Parameter{"reflectance", Takes::reflectance, "0.5", "albedo"}.also("diffuse_reflectance")}};
}

Material bsdf_diffuse(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::diffuse;
    material.front.reflectance = properties.color("reflectance");
    return material;
}

} // namespace gradus
