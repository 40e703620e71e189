// <rfilter type="gaussian">, cut off at four standard deviations.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_gaussian() {
    return {"cut off at four standard deviations; of films that name no filter",
            {Parameter{"stddev", Takes::number, "0.5", "standard deviation"}.in("pixels").at_least(1e-3).at_most(25)}};
}

ReconstructionFilter rfilter_gaussian(Properties &properties, SceneBuilder &) {
    const double stddev = properties.number("stddev");
    return {FilmSettings::Filter::gaussian, float(4 * stddev), float(stddev)};
}

} // namespace gradus
