// <bsdf type="roughdielectric">: a rough boundary between two transparent media.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_roughdielectric() {
    return {"a rough boundary between two transparent media",
            joined({parameters_of_dielectric(), parameters_of_roughness()})};
}

Material bsdf_roughdielectric(Properties &properties, SceneBuilder &) {
    Material material;
    read_dielectric(properties, material.front);
    const bool is_ggx = read_roughness(properties, material.front) == Microfacet::ggx;
    material.front.kind = is_ggx ? BsdfKind::roughdielectric_ggx : BsdfKind::roughdielectric_beckmann;
    return material;
}

} // namespace gradus
