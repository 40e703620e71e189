#include "methods/photons/moved_by_surface.h"

#include "kernels/shared/tables.h"
#include "methods/path_stages.h"
#include "runtime/scene/scene_tables.h"
#include "runtime/scene/traits.h"

#include <algorithm>

namespace gradus {

using namespace lib_float;

namespace {

/// Whether a surface is another one at another place. Walks pass by none of these, for they read no textures.
bool has_textures(const Bsdf &bsdf) {
    return bsdf.map.kind != NormalTexture::Kind::none || !distinct_textures(bsdf).empty();
}

/// Whether photons are not moved that come from there: a mirror or glass that no walk may pass.
bool keeps_photons(const Bsdf &bsdf) { return bsdf_kind_traits(bsdf.kind).is_dirac && has_textures(bsdf); }

/// Whether walks move a vertex there: a specular one, or a glossy one, whose half vector is kept (Hua et al. 2017,
/// section 4.2): held where it is, it would scatter what it sends to its left another way.
bool is_walked(const Bsdf &bsdf, const RenderOptions &options) {
    const BsdfKindTraits &kind = bsdf_kind_traits(bsdf.kind);
    return !has_textures(bsdf) &&
           (kind.is_dirac || (!gathers_photons(bsdf, options.gather_roughness) && !kind.is_mixed));
}

} // namespace

std::vector<std::string> walked_kinds(const Scene &scene, const RenderOptions &options) {
    std::vector<std::string> kinds;
    for_each_bsdf(scene, [&](const Bsdf &bsdf) {
        if (const std::string kind = bsdf_kind_name(bsdf);
            is_walked(bsdf, options) && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
            kinds.push_back(kind);
    });
    return kinds;
}

std::vector<std::uint32_t> bins_of_kinds(const Scene &scene, const std::vector<std::string> &kinds) {
    std::vector<std::uint32_t> bins;
    for (const Bsdf &bsdf : material_records(scene)) {
        const auto kind = std::find(kinds.begin(), kinds.end(), bsdf_kind_name(bsdf));
        bins.push_back(kind == kinds.end() ? bin_none : first_kind_bin + std::uint32_t(kind - kinds.begin()));
    }
    return bins;
}

std::vector<std::uint32_t> bins_of_leaving(const Scene &scene, const std::vector<std::string> &kinds,
                                           const RenderOptions &options) {
    std::vector<std::uint32_t> bins = bins_of_kinds(scene, kinds);
    const std::vector<Bsdf> records = material_records(scene);
    const std::size_t first_part = records.size() - scene.blended.size();
    for (std::size_t i = 0; i < bins.size(); ++i) {
        // Of the parts of a blend walks take the specular ones alone.
        const bool is_in_chain =
            i < first_part ? is_walked(records[i], options) : bsdf_kind_traits(records[i].kind).is_dirac;
        if (keeps_photons(records[i]))
            bins[i] = bin_none;
        else if (is_in_chain || bins[i] == bin_none)
            bins[i] = chain_bin;
    }
    return bins;
}

std::vector<std::uint32_t> kinds_for_walks(const Scene &scene, double gather_roughness) {
    std::vector<std::uint32_t> kinds = material_kinds(scene, gather_roughness, gathers_photons);
    const std::vector<Bsdf> records = material_records(scene);
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (keeps_photons(records[i]))
            kinds[i] = kind_none;
    const std::size_t first_part = kinds.size() - scene.blended.size();
    const auto leave_out = [&](const Bsdf &part) {
        if (bsdf_kind_traits(part.kind).is_dirac)
            kinds[first_part + std::size_t(&part - scene.blended.data())] = kind_none;
    };
    for (const Blend &blend : scene.blends)
        if (blend.weight.texture != no_texture)
            for (const std::uint32_t half : {blend.first, blend.second})
                for_each_part(scene, scene.blended[half], leave_out);
    return kinds;
}

} // namespace gradus
