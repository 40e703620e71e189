// <rfilter type="mitchell">: Mitchell and Netravali (1988).
//   B (1/3), C (1/3)
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_mitchell(Properties &properties, SceneBuilder &) {
    ReconstructionFilter filter{FilmSettings::Filter::mitchell, 2, 0.5f};
    filter.b = float(properties.number("b", 1 / 3.0, -10, 10));
    filter.c = float(properties.number("c", 1 / 3.0, -10, 10));
    return filter;
}

} // namespace gradus
