// <rfilter type="tent">
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_tent() {
    return {"linear from the middle",
            {Parameter{"radius", Takes::number, "1", "half its support"}.in("pixels").at_least(1e-3).at_most(100)}};
}

ReconstructionFilter rfilter_tent(Properties &properties, SceneBuilder &) {
    return {FilmSettings::Filter::tent, float(properties.number("radius")), 0.5f};
}

} // namespace gradus
