// <bsdf type="roughplastic">: a diffuse base under a rough dielectric coat.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_roughplastic() {
    return {"a diffuse base under a rough dielectric coat, as rough along both axes",
            joined({parameters_of_plastic(), parameters_of_roughness()})};
}

Material bsdf_roughplastic(Properties &properties, SceneBuilder &builder) {
    Material material;
    const bool is_ggx = read_roughness(properties, material.front) == Microfacet::ggx;
    if (!(material.front.alpha_u == material.front.alpha_v))
        throw properties.error("alpha_u", "roughplastic is as rough along both axes: give alpha");
    material.front.kind = is_ggx ? BsdfKind::roughplastic_ggx : BsdfKind::roughplastic_beckmann;
    read_plastic(properties, material.front);
    builder.set_coating(material.front);
    return material;
}

} // namespace gradus
