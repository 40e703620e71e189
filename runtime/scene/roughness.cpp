#include "runtime/scene/roughness.h"

#include "runtime/scene/traits.h"

#include <algorithm>
#include <set>

namespace gradus {

bool is_rough(const Bsdf &bsdf, double threshold) {
    const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
    // As float, which the scene's are: 0.02 is not below 0.02.
    const auto least = float(threshold);
    return !kind.is_dirac && (!kind.has_roughness || std::min(bsdf.alpha_u, bsdf.alpha_v) >= least);
}

bool gathers_photons(const Bsdf &bsdf, double threshold) {
    return is_rough(bsdf, threshold) && !bsdf_kind_traits(bsdf.kind).is_mixed;
}

GatheringSurfaces gathering_surfaces(const Scene &scene, double threshold) {
    GatheringSurfaces surfaces;
    const auto count = [&](const Bsdf &bsdf) {
        ++(gathers_photons(bsdf, threshold) ? surfaces.gathered : surfaces.passed)[bsdf_kind_name(bsdf)];
    };
    std::set<std::uint32_t> used;
    for (const Shape &shape : scene.shapes)
        used.insert(shape.material);
    for (const std::uint32_t material : used) {
        for_each_part(scene, scene.materials[material].front, count);
        if (scene.materials[material].two_sided)
            for_each_part(scene, scene.materials[material].back, count);
    }
    return surfaces;
}

} // namespace gradus
