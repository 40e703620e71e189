// Options of photon methods.
#pragma once

#include "methods/method.h"

#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace gradus {

/// A radius as --radius has it: "2" in widths of a pixel, "0.5%" of the scene's diameter. Nothing where it is neither,
/// or not above 0.
std::optional<RenderOptions::GatherRadius> gather_radius(const std::string &text);

/// --photons, --gather-roughness, --direct, --only-chains, --radius, --radius-alpha.
void add_photon_options(CLI::App &command, RenderOptions &options);

} // namespace gradus
