// <bsdf type="mask">: a BSDF in a surface with holes.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_mask() {
    return {
        "a BSDF in a surface with holes, also in another mask or a blend. A hole is no edge of a path, and light "
        "samples pass it, as with Mitsuba's `volpath`; its `path` counts it in max_depth and loses light behind it. A "
        "shape that emits is met by all rays",
        {Parameter{"opacity", Takes::textured_number, "0.5",
                   "share of the rays that meet the surface; the others pass as with `null`"}
             .at_least(0)
             .at_most(1),
         {"bsdf", Takes::objects, nullptr, "one"}}};
}

Material bsdf_mask(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("bsdf");
    if (nested.size() != 1)
        throw SceneError(properties.location(), "mask needs one nested BSDF, not " + std::to_string(nested.size()));
    Material material = builder.build_object<Material>(*nested.front().element);
    Number opacity = properties.textured_number("opacity");
    // Of a mask in a mask rays must meet both.
    const Number within = material.opacity;
    if (opacity.texture != no_texture && within.texture != no_texture)
        throw SceneError(nested.front().location,
                         "a mask inside a mask, both with textures, is not supported: give one texture their product");
    if (opacity.texture != no_texture)
        opacity.texture = builder.scaled(opacity.texture, within);
    if (within.texture != no_texture)
        opacity.texture = builder.scaled(within.texture, opacity);
    opacity *= within;
    material.opacity = opacity;
    return material;
}

} // namespace gradus
