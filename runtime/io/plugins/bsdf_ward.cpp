// <bsdf type="ward">, of Mitsuba 0.x: Ward's anisotropic lobe beside a diffuse one.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_ward() {
    return {"Ward's anisotropic lobe beside a diffuse one, of 0.x",
            joined({parameters_of_two_lobes(),
                    {Parameter{"variant", Takes::choice, "balanced", "how the lobe is normalised"}.of(
                         {"ward", "ward-duer", "balanced"}),
                     Parameter{"alpha", Takes::textured_number, "0.1", "roughness"}.at_least(0).at_most(1e30).raised_to(
                         1e-4),
                     Parameter{"alpha_u", Takes::textured_number, nullptr, "roughness along dp/du"}
                         .as("alpha")
                         .at_least(0)
                         .at_most(1e30)
                         .raised_to(1e-4),
                     Parameter{"alpha_v", Takes::textured_number, nullptr, "roughness across it"}
                         .as("alpha")
                         .at_least(0)
                         .at_most(1e30)
                         .raised_to(1e-4)}})};
}

Material bsdf_ward(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::ward;
    const std::string variant = properties.choice("variant");
    bsdf.ward_variant = variant == "ward" ? 0.0f : variant == "ward-duer" ? 1.0f : 2.0f;
    read_two_lobes(properties, bsdf);
    bsdf.alpha_u = properties.textured_number("alpha_u");
    bsdf.alpha_v = properties.textured_number("alpha_v");
    return material;
}

} // namespace gradus
