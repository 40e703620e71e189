// <bsdf type="twosided">: gives a one-sided BSDF a back. One nested BSDF serves both sides; of two, the first is the
// front and the second the back. Of one that has two sides itself, the front serves both.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_twosided() {
    return {"gives a one-sided BSDF a back",
            {{"bsdf", Takes::objects, nullptr, "one for both sides, or two: front and back"},
             {"allow_transmission", Takes::boolean, "false",
              "one that lets light through is taken as it is, where it is the same from both sides: thindielectric, "
              "principledthin or null, without a map"}}};
}

namespace {

/// Whether it lets light through and does from behind what it does from the front, so that there is nothing to add.
bool has_like_sides(const Bsdf &bsdf) {
    return bsdf.blend == no_blend && bsdf.map == NormalTexture() &&
           (bsdf.kind == BsdfKind::thindielectric || bsdf.kind == BsdfKind::principledthin ||
            bsdf.kind == BsdfKind::null);
}

} // namespace

Material bsdf_twosided(Properties &properties, SceneBuilder &builder) {
    const bool allows_transmission = properties.boolean("allow_transmission");
    const auto nested = properties.objects("bsdf");
    if (nested.empty() || nested.size() > 2)
        throw SceneError(properties.location(),
                         "twosided needs one nested BSDF or two, not " + std::to_string(nested.size()));
    Material sides[2];
    for (std::size_t i = 0; i < nested.size(); ++i) {
        sides[i] = builder.build_object<Material>(*nested[i].element);
        if (allows_transmission && nested.size() == 1 && has_like_sides(sides[i].front))
            return sides[i];
        if (builder.transmits(sides[i].front))
            throw SceneError(nested[i].location, "twosided cannot hold a BSDF that lets light through: leave twosided "
                                                 "away, such a BSDF has two sides itself");
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
