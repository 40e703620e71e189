#include "runtime/scene/roughness.h"

#include "runtime/scene/traits.h"

#include <algorithm>
#include <set>

namespace gradus {

namespace {

// A microfacet that is tilted by t turns what it mirrors by 2 t, and what it refracts by |eta - 1| t on the way out of
// an index eta (by Walter et al. 2007, eq. 16 and 17, of small t): with an index near 1 that lobe is nearly a Dirac one
// at any roughness. Ice (1.31), water and glass bend enough to count by roughness alone, as what mirrors does.
constexpr float least_bend = 0.3f;

/// How wide what passes the surface is, over what roughness says: 1 of glass of this index and of all that bends more,
/// or that lets nothing pass.
float width_of_passed(const Bsdf &bsdf) {
    if (!bsdf_kind_traits(bsdf.kind).refracts)
        return 1;
    if (bsdf.kind == BsdfKind::principledthin) {
        // It mirrors what passes to the other side, off microfacets of this share of the roughness, whose square is
        // alpha (kernels/lib/bsdf_principledthin.h), and so twice as far as they are tilted.
        const float share = 0.65f * bsdf.ior - 0.35f;
        return std::min(1.0f, 2 * share * share / least_bend);
    }
    const float bend = bsdf.ior > 0 ? std::max(float(bsdf.ior), 1 / bsdf.ior) - 1 : 1;
    return std::min(1.0f, bend / least_bend);
}

} // namespace

bool is_rough(const Bsdf &bsdf, double threshold) {
    const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
    // As float, which the scene's are: 0.02 is not below 0.02.
    const auto least = float(threshold);
    return !kind.is_dirac && (!kind.has_roughness || std::min(bsdf.alpha_u, bsdf.alpha_v) >= least);
}

bool gathers_photons(const Bsdf &bsdf, double threshold) {
    const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
    if (!is_rough(bsdf, threshold) || kind.is_mixed)
        return false;
    return !kind.has_roughness || std::min(bsdf.alpha_u, bsdf.alpha_v) * width_of_passed(bsdf) >= float(threshold);
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
