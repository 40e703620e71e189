// <bsdf type="roughdiffuse">, of Mitsuba 0.x: a surface of diffuse facets.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_roughdiffuse() {
    return {"a surface of diffuse facets (Oren and Nayar), of 0.x",
            {Parameter{"reflectance", Takes::reflectance, "0.5", "albedo of the facets"}.also("diffuse_reflectance"),
             Parameter{"alpha", Takes::textured_number, "0.2", "roughness, as that of Beckmann's microfacets"}
                 .at_least(0)
                 .at_most(1e15),
             {"use_fast_approx", Takes::boolean, "false", "the model's short form"}}};
}

Material bsdf_roughdiffuse(Properties &properties, SceneBuilder &) {
    Material material;
    material.front.kind = BsdfKind::roughdiffuse;
    material.front.reflectance = properties.color("reflectance");
    material.front.facet_alpha = properties.textured_number("alpha");
    material.front.fast_approximation = properties.boolean("use_fast_approx") ? 1.0f : 0.0f;
    return material;
}

} // namespace gradus
