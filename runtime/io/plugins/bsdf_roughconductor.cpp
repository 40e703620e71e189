// <bsdf type="roughconductor">: a rough metal.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_roughconductor() {
    return {"a rough metal", joined({parameters_of_conductor(), parameters_of_roughness()})};
}

Material bsdf_roughconductor(Properties &properties, SceneBuilder &) {
    Material material;
    read_conductor(properties, material.front);
    const bool is_ggx = read_roughness(properties, material.front) == Microfacet::ggx;
    material.front.kind = is_ggx ? BsdfKind::roughconductor_ggx : BsdfKind::roughconductor_beckmann;
    return material;
}

} // namespace gradus
