// <bsdf type="null">: a surface that light passes as if it were not there.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_null(Properties &, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::null;
    return material;
}

} // namespace gradus
