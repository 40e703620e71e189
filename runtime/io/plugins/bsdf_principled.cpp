// <bsdf type="principled">: Disney's model of many materials (Burley 2012, 2015).
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Declaration declare_bsdf_principled() {
    return {
        "Disney's model of many materials (Burley 2012, 2015)",
        joined(
            {parameters_of_principled(),
             {Parameter{"metallic", Takes::textured_number, "0", "from a dielectric to a metal"}.at_least(0).at_most(1),
              Parameter{"clearcoat", Takes::textured_number, "0", "strength of a second, colourless lobe"}
                  .at_least(0)
                  .at_most(1),
              Parameter{"clearcoat_gloss", Takes::textured_number, "0", "how glossy that one is"}.at_least(0).at_most(
                  1),
              Parameter{"eta", Takes::refractive_index, nullptr, "index of refraction; not beside specular"}.or_else(
                  "by specular"),
              Parameter{"specular", Takes::number, "0.5", "reflectance ahead over 0.08"}.at_least(0).at_most(1)},
             meaningless(
                 {"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"})})};
}

Material bsdf_principled(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    read_principled(properties, bsdf);
    const auto share = [&](const char *name) { return properties.textured_number(name); };
    bsdf.metallic = share("metallic");
    bsdf.clearcoat = share("clearcoat");
    bsdf.clearcoat_gloss = share("clearcoat_gloss");
    const bool is_clear = bsdf.spec_trans.texture != no_texture || bsdf.spec_trans > 0;
    bsdf.kind = is_clear ? BsdfKind::principled_clear : BsdfKind::principled;
    if (properties.has("eta") && properties.has("specular"))
        throw properties.error("specular", "give eta or specular, not both");
    // Index 1, which specular 0 stands for, has no half vectors of refraction.
    const double specular = properties.number("specular");
    const double reflectance = 0.08 * (is_clear ? std::max(specular, 1e-3) : specular);
    const double eta =
        properties.has("eta") ? properties.refractive_index("eta") : 2 / (1 - std::sqrt(reflectance)) - 1;
    bsdf.ior = float(is_clear && eta == 1 ? 1.001 : eta);
    return material;
}

} // namespace gradus
