// <bsdf type="dielectric">: a smooth boundary between two transparent media.
//   int_ior, ext_ior, specular_reflectance, specular_transmittance
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_dielectric(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::dielectric;
    read_dielectric(properties, material.front);
    properties.ignore({"alpha", "distribution"}); // left over in files whose surface was rough once
    return material;
}

} // namespace gradus
