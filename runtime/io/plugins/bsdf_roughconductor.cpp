// <bsdf type="roughconductor">: a rough metal.
//   those of conductor; distribution, alpha or alpha_u and alpha_v
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_roughconductor(Properties &properties, SceneBuilder &) {
    Material material;
    read_conductor(properties, material.front);
    const bool is_ggx = read_roughness(properties, material.front) == Microfacet::ggx;
    material.front.kind = is_ggx ? BsdfKind::roughconductor_ggx : BsdfKind::roughconductor_beckmann;
    return material;
}

} // namespace gradus
