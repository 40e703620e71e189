// <bsdf type="null">: a surface that light passes as if it were not there.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_null() {
    return {"a surface that light passes as if it were not there; it counts as no edge of a path", {}};
}

Material bsdf_null(Properties &, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::null;
    return material;
}

} // namespace gradus
