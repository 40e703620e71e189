// Refractive indices of materials by name.
#pragma once

#include "runtime/scene/scene.h"

#include <optional>
#include <string>
#include <vector>

namespace gradus {

/// Index of refraction of a transparent material at 589 nm, by its name without regard to case ("bk7", "water").
std::optional<double> dielectric_index(const std::string &name);
std::vector<std::string> dielectric_names();

/// eta + i k by colour channel, relative to vacuum.
struct ConductorIndex {
    Rgb eta, k;
};
/// By name without regard to case ("Al", "Cu"); "none" is a perfect mirror.
std::optional<ConductorIndex> conductor_index(const std::string &name);
std::vector<std::string> conductor_names();

} // namespace gradus
