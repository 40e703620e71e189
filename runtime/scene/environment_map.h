// An image of the light from all directions, as kernels read it (kernels/lib/environment.h), with the alias tables by
// which its directions are sampled.
#pragma once

#include "runtime/scene/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace gradus {

struct EnvironmentMap {
    std::uint32_t columns = 1;         ///< of texels, and of cells: the last one ends at the first column again
    std::uint32_t rows = 0;            ///< of cells: one less than of texels
    std::vector<std::uint32_t> texels; ///< two words each, columns + 1 in a row
    std::vector<std::uint32_t> cells;  ///< by strip: threshold and alias within it
    std::vector<std::uint32_t> strips; ///< two words each: threshold and alias
    float unit = 1;                    ///< radiance that the number 1 in a texel stands for
    float scale = 0;                   ///< density by solid angle times the sine from the pole, over the importance
    Rgb integral;                      ///< of radiance over all directions, W m^-2
};

/// The largest number of texels, which keeps every index within 32 bits.
inline constexpr std::uint64_t most_environment_texels = std::uint64_t(1) << 29;

/// The most rows of a map so wide. Each row has strips of its own, 256 cells that take 1 KiB: narrow maps would take
/// far more than their texels, and a strip's number is to be within 22 bits.
std::uint64_t most_environment_rows(std::uint32_t width);

/// Of an image of width x height texels, row by row from +y (the top) down. The planes hold linear radiance, finite and
/// not negative. Numbers are rounded to 11 bits, which loses nothing of half floats and RGBE. A row alone counts as
/// two. Works on all cores; what comes out does not depend on how many.
EnvironmentMap make_environment_map(std::uint32_t width, std::uint32_t height, std::span<const float> red,
                                    std::span<const float> green, std::span<const float> blue);

/// Bytes that it takes on the device.
std::size_t environment_bytes(const EnvironmentMap &map);

/// A map for kernels that are compiled for one and have none: they read it and take nothing of it.
EnvironmentMap no_environment_map();

} // namespace gradus
