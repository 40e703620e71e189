// <bsdf type="normalmap">: a BSDF under normals that a texture holds.
#include "runtime/io/plugins/parameters_of_maps.h"

namespace gradus {

Declaration declare_bsdf_normalmap() {
    return {"a BSDF under normals that a texture holds",
            joined({{{"texture", Takes::objects, nullptr, "in 2.0 and later its name is normalmap; to be read raw"}},
                    parameters_of_maps()})};
}

Material bsdf_normalmap(Properties &properties, SceneBuilder &builder) {
    return read_mapped(properties, builder, NormalTexture::Kind::normal);
}

} // namespace gradus
