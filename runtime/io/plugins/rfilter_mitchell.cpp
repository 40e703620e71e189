// <rfilter type="mitchell">: Mitchell and Netravali (1988).
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_mitchell() {
    return {"Mitchell and Netravali (1988)",
            {Parameter{"b", Takes::number, "0.3333333333333333", "their B"}.at_least(-10).at_most(10),
             Parameter{"c", Takes::number, "0.3333333333333333", "their C"}.at_least(-10).at_most(10)}};
}

ReconstructionFilter rfilter_mitchell(Properties &properties, SceneBuilder &) {
    ReconstructionFilter filter{FilmSettings::Filter::mitchell, 2, 0.5f};
    filter.b = float(properties.number("b"));
    filter.c = float(properties.number("c"));
    return filter;
}

} // namespace gradus
