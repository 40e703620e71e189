// Which surfaces count as rough: for shifts that reconnect there, and for photons that are gathered there.
#pragma once

#include "runtime/scene/scene.h"

#include <cstdint>
#include <map>
#include <string>

namespace gradus {

/// Whether a surface counts as rough: not Dirac, and of this roughness (alpha) or more where it has one. Of one with
/// a Dirac lobe beside rough ones, whether these count.
bool is_rough(const Bsdf &bsdf, double threshold);

/// Whether photons are kept and gathered there: where it counts as rough, has no Dirac lobe, and what passes it is wide
/// enough, too, which it is not with an index near 1. Paths go on from others as from glossy ones, so that either lobe
/// is sampled.
bool gathers_photons(const Bsdf &bsdf, double threshold);

/// BSDFs of materials that shapes have, by the name of their kind; a material with two sides counts twice.
struct GatheringSurfaces {
    std::map<std::string, std::uint64_t> gathered; ///< rough: photons are kept and gathered there
    std::map<std::string, std::uint64_t> passed;   ///< smoother: camera paths and light paths go on
};

/// As roughness (alpha) `threshold` parts them.
GatheringSurfaces gathering_surfaces(const Scene &scene, double threshold);

} // namespace gradus
