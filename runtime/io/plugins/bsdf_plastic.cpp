// <bsdf type="plastic">: a diffuse base under a smooth dielectric coat.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_plastic() {
    return {"a diffuse base under a smooth dielectric coat", joined({parameters_of_plastic(), roughness_left_over()})};
}

Material bsdf_plastic(Properties &properties, SceneBuilder &builder) {
    Material material;
    material.front.kind = BsdfKind::plastic;
    read_plastic(properties, material.front);
    builder.set_coating(material.front);
    return material;
}

} // namespace gradus
