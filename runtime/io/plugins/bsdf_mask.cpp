// <bsdf type="mask">: a BSDF in a surface with holes.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_mask() {
    return {"a BSDF in a surface with holes. A shape that emits is met by all rays",
            {{"opacity", Takes::reflectance, "0.5",
              "share of the rays that meet the surface, of a colour its luminance; the others pass as with `null`"},
             {"bsdf", Takes::objects, nullptr, "one"}}};
}

Material bsdf_mask(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("bsdf");
    if (nested.size() != 1)
        throw SceneError(properties.location(), "mask needs one nested BSDF, not " + std::to_string(nested.size()));
    Material material = builder.build_object<Material>(*nested.front().element);
    if (material.opacity != 1.0f)
        throw SceneError(nested.front().location, "mask inside mask is not supported: give one of them both opacities");
    const Color opacity = properties.color("opacity");
    material.opacity = 0.2126f * opacity.r + 0.7152f * opacity.g + 0.0722f * opacity.b;
    material.opacity.texture = opacity.texture;
    return material;
}

} // namespace gradus
