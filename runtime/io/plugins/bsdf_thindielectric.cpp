// <bsdf type="thindielectric">: a thin pane with the same medium on both sides.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_thindielectric() {
    return {"a thin pane with the same medium on both sides", parameters_of_dielectric()};
}

Material bsdf_thindielectric(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::thindielectric;
    read_dielectric(properties, material.front);
    material.front.pane_ior = material.front.ior;
    return material;
}

} // namespace gradus
