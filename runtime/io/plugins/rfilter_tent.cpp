// <rfilter type="tent">
//   radius  half its support, in pixels, 1
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_tent(Properties &properties, SceneBuilder &) {
    return {FilmSettings::Filter::tent, float(properties.number("radius", 1, 1e-3, 100)), 0.5f};
}

} // namespace gradus
