// <bsdf type="roughdielectric">: a rough boundary between two transparent media.
//   those of dielectric; distribution, alpha or alpha_u and alpha_v
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_roughdielectric(Properties &properties, SceneBuilder &) {
    Material material;
    read_dielectric(properties, material.front);
    const bool is_ggx = read_roughness(properties, material.front) == Microfacet::ggx;
    material.front.kind = is_ggx ? BsdfKind::roughdielectric_ggx : BsdfKind::roughdielectric_beckmann;
    return material;
}

} // namespace gradus
