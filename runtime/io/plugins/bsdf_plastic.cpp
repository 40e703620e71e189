// <bsdf type="plastic">: a diffuse base under a smooth dielectric coat.
//   diffuse_reflectance (0.5), specular_reflectance (1), int_ior (polypropylene), ext_ior (air), nonlinear (false)
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_plastic(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::plastic;
    read_plastic(properties, material.front);
    properties.ignore({"alpha", "distribution"}); // left over in files whose surface was rough once
    return material;
}

} // namespace gradus
