// <rfilter type="box">: each sample counts for the pixel it falls into.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_box(Properties &properties, SceneBuilder &) {
    properties.ignore({"radius"}); // half a pixel, whatever old files say
    return {FilmSettings::Filter::box, 0.5f, 0.5f};
}

} // namespace gradus
