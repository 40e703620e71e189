// <bsdf type="bumpmap">: a BSDF under the normals of a surface that a texture raises.
#include "runtime/io/plugins/parameters_of_maps.h"

namespace gradus {

Declaration declare_bsdf_bumpmap() {
    return {
        "a BSDF under the normals of a surface that a texture raises",
        joined({{{"texture", Takes::objects, nullptr, "of one number or of a colour, whose luminance is the height"},
                 Parameter{"scale", Takes::number, "1", "how high a luminance of 1 is"}.in("lengths")},
                parameters_of_maps()})};
}

Material bsdf_bumpmap(Properties &properties, SceneBuilder &builder) {
    return read_mapped(properties, builder, NormalTexture::Kind::bump);
}

} // namespace gradus
