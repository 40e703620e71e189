// <rfilter type="lanczos">: a sinc in the first lobe of a wider one.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_lanczos() {
    return {"a sinc in the first lobe of a wider one",
            {Parameter{"lobes", Takes::integer, "3", "half its support"}.in("pixels").at_least(1).at_most(20)}};
}

ReconstructionFilter rfilter_lanczos(Properties &properties, SceneBuilder &) {
    return {FilmSettings::Filter::lanczos, float(properties.integer("lobes")), 0.5f};
}

} // namespace gradus
