// <rfilter type="lanczos">: a sinc in the first lobe of a wider one.
//   lobes  3
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_lanczos(Properties &properties, SceneBuilder &) {
    return {FilmSettings::Filter::lanczos, float(properties.integer("lobes", 3, 1, 20)), 0.5f};
}

} // namespace gradus
