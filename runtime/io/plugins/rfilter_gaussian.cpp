// <rfilter type="gaussian">, cut off at four standard deviations.
//   stddev  in pixels, 0.5
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_gaussian(Properties &properties, SceneBuilder &) {
    const double stddev = properties.number("stddev", 0.5, 1e-3, 25);
    return {FilmSettings::Filter::gaussian, float(4 * stddev), float(stddev)};
}

} // namespace gradus
