// <bsdf type="blendbsdf">: a mixture of two BSDFs, which may be mixtures again.
#include "runtime/io/plugins/parameters_of_blends.h"
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_bsdf_blendbsdf() {
    return {"a mixture of two BSDFs, each of which may be a mixture again. A part `null` is no hole of a `mask`: it "
            "counts as an edge, and light samples do not pass it",
            {Parameter{"weight", Takes::textured_number, "0.5", "share of the second"}.at_least(0).at_most(1),
             {"bsdf", Takes::objects, nullptr, "the first and the second"}}};
}

Material bsdf_blendbsdf(Properties &properties, SceneBuilder &builder) {
    const auto nested = properties.objects("bsdf");
    if (nested.size() != 2)
        throw SceneError(properties.location(),
                         "blendbsdf needs two nested BSDFs, not " + std::to_string(nested.size()));
    return blended(builder.build_object<Material>(*nested[0].element),
                   builder.build_object<Material>(*nested[1].element), properties.textured_number("weight"), builder,
                   properties.location());
}

} // namespace gradus
