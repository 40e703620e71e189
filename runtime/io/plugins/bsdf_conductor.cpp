// <bsdf type="conductor">: a smooth metal.
//   material, or eta and k; ext_eta, specular_reflectance
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_conductor(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::conductor;
    read_conductor(properties, material.front);
    properties.ignore({"alpha", "distribution"}); // left over in files whose surface was rough once
    return material;
}

} // namespace gradus
