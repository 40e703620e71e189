// <bsdf type="principled">: Disney's model of many materials (Burley 2012, 2015).
//   base_color (0.5), roughness (0.5), anisotropic, metallic, spec_trans, spec_tint, sheen, sheen_tint, flatness,
//   clearcoat, clearcoat_gloss (0), eta or specular (0.5)
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Material bsdf_principled(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    read_principled(properties, bsdf);
    const auto share = [&](const char *name) { return properties.textured_number(name, 0.0f, 0, 1, 0); };
    bsdf.metallic = share("metallic");
    bsdf.clearcoat = share("clearcoat");
    bsdf.clearcoat_gloss = share("clearcoat_gloss");
    const bool is_clear = bsdf.spec_trans.texture != no_texture || bsdf.spec_trans > 0;
    bsdf.kind = is_clear ? BsdfKind::principled_clear : BsdfKind::principled;
    if (properties.has("eta") && properties.has("specular"))
        throw properties.error("specular", "give eta or specular, not both");
    // Index 1, which specular 0 stands for, has no half vectors of refraction.
    const double specular = properties.number("specular", 0.5, 0, 1);
    const double reflectance = 0.08 * (is_clear ? std::max(specular, 1e-3) : specular);
    const double eta = properties.refractive_index("eta", std::to_string(2 / (1 - std::sqrt(reflectance)) - 1));
    bsdf.ior = float(is_clear && eta == 1 ? 1.001 : eta);
    properties.ignore({"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"});
    return material;
}

} // namespace gradus
