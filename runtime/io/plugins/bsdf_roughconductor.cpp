// <bsdf type="roughconductor">: a rough metal.
//   those of conductor; distribution, alpha or alpha_u and alpha_v
#include "runtime/io/plugins/parameters.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_roughconductor(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::roughconductor;
    read_conductor(properties, material.front);
    read_roughness(properties, material.front);
    return material;
}

} // namespace gradus
