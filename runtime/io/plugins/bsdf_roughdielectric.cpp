// <bsdf type="roughdielectric">: a rough boundary between two transparent media.
//   those of dielectric; distribution, alpha or alpha_u and alpha_v
#include "runtime/io/plugins/parameters.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_roughdielectric(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::roughdielectric;
    read_dielectric(properties, material.front);
    read_roughness(properties, material.front);
    return material;
}

} // namespace gradus
