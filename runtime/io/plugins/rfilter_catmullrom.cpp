// <rfilter type="catmullrom">
#include "runtime/io/plugins/plugin.h"

namespace gradus {

ReconstructionFilter rfilter_catmullrom(Properties &properties, SceneBuilder &) {
    properties.ignore({"b", "c"}); // 0 and 1/2, whatever files say
    return {FilmSettings::Filter::catmullrom, 2, 0.5f};
}

} // namespace gradus
