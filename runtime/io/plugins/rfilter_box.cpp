// <rfilter type="box">: each sample counts for the pixel it falls into.
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_box() {
    return {"each sample counts for the pixel it falls into, whatever radius old files say", meaningless({"radius"})};
}

ReconstructionFilter rfilter_box(Properties &, SceneBuilder &) { return {FilmSettings::Filter::box, 0.5f, 0.5f}; }

} // namespace gradus
