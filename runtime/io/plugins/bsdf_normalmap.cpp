// <bsdf type="normalmap">: a BSDF under normals that a texture holds.
//   a texture (in 2.0 and later named normalmap) and a BSDF; flip_invalid_normals, use_shadowing_function
#include "runtime/io/plugins/parameters_of_maps.h"

namespace gradus {

Material bsdf_normalmap(Properties &properties, SceneBuilder &builder) {
    return read_mapped(properties, builder, NormalTexture::Kind::normal);
}

} // namespace gradus
