// <bsdf type="principledthin">: Disney's model of thin surfaces (Burley 2015).
//   base_color (0.5), roughness (0.5), anisotropic, spec_trans, spec_tint, sheen, sheen_tint, flatness, diff_trans (0),
//   eta (1.5)
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Material bsdf_principledthin(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::principledthin;
    read_principled(properties, bsdf);
    bsdf.diff_trans = properties.textured_number("diff_trans", 0.0f, 0, 2, 0);
    bsdf.ior = float(properties.refractive_index("eta", "1.5"));
    properties.ignore({"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                       "specular_transmittance_sampling_rate", "diffuse_transmittance_sampling_rate"});
    return material;
}

} // namespace gradus
