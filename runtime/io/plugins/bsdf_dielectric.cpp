// <bsdf type="dielectric">: a smooth boundary between two transparent media.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_dielectric() {
    return {"a smooth boundary between two transparent media",
            joined({parameters_of_dielectric(), roughness_left_over()})};
}

Material bsdf_dielectric(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::dielectric;
    read_dielectric(properties, material.front);
    return material;
}

} // namespace gradus
