// <bsdf type="twosided">: gives a one-sided BSDF a back. One nested BSDF serves both sides; of two, the first is the
// front and the second the back. Of one that has two sides itself, the front serves both.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_twosided() {
    return {"gives a one-sided BSDF a back",
            {{"bsdf", Takes::objects, nullptr, "one for both sides, or two: front and back"}}};
}

Material bsdf_twosided(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("bsdf");
    if (nested.empty() || nested.size() > 2)
        throw SceneError(properties.location(),
                         "twosided needs one nested BSDF or two, not " + std::to_string(nested.size()));
    Material sides[2];
    for (std::size_t i = 0; i < nested.size(); ++i) {
        sides[i] = builder.build_object<Material>(*nested[i].element);
        if (builder.transmits(sides[i].front))
            throw SceneError(nested[i].location, "twosided cannot hold a BSDF that lets light through");
        if (sides[i].two_sided && nested.size() == 2)
            throw SceneError(nested[i].location, "a side of a twosided has two sides itself; give it one of them");
    }
    if (nested.size() == 2 && sides[0].opacity != sides[1].opacity)
        throw SceneError(nested[1].location, "both sides of a surface have one opacity");
    Material material = sides[0];
    material.back = sides[nested.size() - 1].front;
    material.two_sided = true;
    return material;
}

} // namespace gradus
