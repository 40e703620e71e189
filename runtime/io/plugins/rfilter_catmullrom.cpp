// <rfilter type="catmullrom">
#include "runtime/io/plugins/plugin.h"

namespace gradus {

Declaration declare_rfilter_catmullrom() { return {"Mitchell's with B 0 and C 1/2", meaningless({"b", "c"})}; }

ReconstructionFilter rfilter_catmullrom(Properties &, SceneBuilder &) {
    return {FilmSettings::Filter::catmullrom, 2, 0.5f};
}

} // namespace gradus
