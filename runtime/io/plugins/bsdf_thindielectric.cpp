// <bsdf type="thindielectric">: a thin pane with the same medium on both sides.
//   those of dielectric
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_thindielectric(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::thindielectric;
    read_dielectric(properties, material.front);
    material.front.pane_ior = material.front.ior;
    return material;
}

} // namespace gradus
