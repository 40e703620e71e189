// <bsdf type="bumpmap">: a BSDF under the normals of a surface that a texture raises.
//   a texture and a BSDF; scale (1, lengths for a luminance of 1), flip_invalid_normals, use_shadowing_function
#include "runtime/io/plugins/parameters_of_maps.h"

namespace gradus {

Material bsdf_bumpmap(Properties &properties, SceneBuilder &builder) {
    return read_mapped(properties, builder, NormalTexture::Kind::bump);
}

} // namespace gradus
