// <bsdf type="principledthin">: Disney's model of thin surfaces (Burley 2015).
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_principledthin() {
    return {"Disney's model of thin surfaces (Burley 2015)",
            joined({parameters_of_principled(),
                    {Parameter{"diff_trans", Takes::textured_number, "0", "of the diffuse light, half of what passes"}
                         .at_least(0)
                         .at_most(2),
                     {"eta", Takes::refractive_index, "1.5", "index of refraction"}},
                    meaningless({"diffuse_reflectance_sampling_rate", "specular_reflectance_sampling_rate",
                                 "specular_transmittance_sampling_rate", "diffuse_transmittance_sampling_rate"})})};
}

Material bsdf_principledthin(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::principledthin;
    read_principled(properties, bsdf);
    bsdf.diff_trans = properties.textured_number("diff_trans");
    bsdf.ior = float(properties.refractive_index("eta"));
    return material;
}

} // namespace gradus
