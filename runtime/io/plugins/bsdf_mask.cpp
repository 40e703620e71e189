// <bsdf type="mask">: a BSDF in a surface with holes.
//   opacity  share of the rays that meet the surface (0.5), or a texture; the others pass as if nothing were there
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_mask(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("bsdf");
    if (nested.size() != 1)
        throw SceneError(properties.location(), "mask needs one nested BSDF, not " + std::to_string(nested.size()));
    Material material = builder.build_object<Material>(*nested.front().element);
    if (material.opacity != 1.0f)
        throw SceneError(nested.front().location, "mask inside mask is not supported: give one of them both opacities");
    const Color opacity = properties.color("opacity", {0.5f, 0.5f, 0.5f}, ColorUse::reflectance);
    material.opacity = 0.2126f * opacity.r + 0.7152f * opacity.g + 0.0722f * opacity.b;
    material.opacity.texture = opacity.texture;
    return material;
}

} // namespace gradus
