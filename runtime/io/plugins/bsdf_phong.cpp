// <bsdf type="phong">, of Mitsuba 0.x: a lobe around the mirror direction beside a diffuse one.
#include "runtime/io/plugins/parameters_of_bsdfs.h"
#include "runtime/io/plugins/plugin.h"

#include <cmath>

namespace gradus {

Declaration declare_bsdf_phong() {
    return {"a lobe around the mirror direction beside a diffuse one, of 0.x",
            joined({parameters_of_two_lobes(),
                    {Parameter{"exponent", Takes::textured_number, "30", "of the lobe's cosine"}.at_least(0).at_most(
                        1e30)}})};
}

Material bsdf_phong(Properties &properties, SceneBuilder &) {
    Material material;
    Bsdf &bsdf = material.front;
    bsdf.kind = BsdfKind::phong;
    read_two_lobes(properties, bsdf);
    float most = 0;
    bsdf.exponent = properties.textured_number("exponent", &most);
    // Of Beckmann's microfacets whose lobe is as wide, where it is the least rough.
    bsdf.alpha_u = bsdf.alpha_v = std::sqrt(2 / (most + 2));
    return material;
}

} // namespace gradus
