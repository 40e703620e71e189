// What each surface lets photons do that are to be moved: those that come from it, and walks that lead by it.
#pragma once

#include "methods/method.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus {

/// Bins of photons that are moved: by the kind of their last vertex (first_kind_bin and on), those at the end of chains
/// before them, those straight from a light behind them.
constexpr std::uint32_t chain_bin = 0, first_kind_bin = 1;

/// The BSDF kinds of surfaces whose vertices walks move.
std::vector<std::string> walked_kinds(const Scene &scene, const RenderOptions &options);

/// By material record, the bin of its kind. `kinds`: SceneTables::kinds.
std::vector<std::uint32_t> bins_of_kinds(const Scene &scene, const std::vector<std::string> &kinds);

/// By material record, the bin of photons that come from there; bin_none: they stay.
std::vector<std::uint32_t> bins_of_leaving(const Scene &scene, const std::vector<std::string> &kinds,
                                           const RenderOptions &options);

/// By material record, the kind as ManifoldWalk asks for it. No walk leads by surfaces of no kind: photons stay there,
/// or they are specular parts of blends whose weight is a texture, which have another chance at another place.
std::vector<std::uint32_t> kinds_for_walks(const Scene &scene, double gather_roughness);

} // namespace gradus
