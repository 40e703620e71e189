// <bsdf type="conductor">: a smooth metal.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_conductor() {
    return {"a smooth metal", joined({parameters_of_conductor(), roughness_left_over()})};
}

Material bsdf_conductor(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::conductor;
    read_conductor(properties, material.front);
    return material;
}

} // namespace gradus
