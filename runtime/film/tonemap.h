// Linear radiance to 8-bit sRGB for looking at.
#pragma once

#include "runtime/film/image.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace gradus {

/// The transfer curve of sRGB (IEC 61966-2-1), linear to encoded; both in [0, 1], not clamped.
float srgb_encode(float linear);
/// Its inverse.
float srgb_decode(float encoded);

/// R, G, B interleaved, 8 bits each: the values times 1 (exposure 0 stops), clamped to [0, 1], sRGB curve, rounded to
/// nearest. No other curve, so that equal pixels mean equal radiance. Infinity becomes 255, NaN 0.
/// Throws Error(ExitCode::image) where one of the channels is missing.
std::vector<std::uint8_t> tonemap(const Image &image);
/// The same for rows [first_row, end_row).
void tonemap(const Image &image, std::size_t first_row, std::size_t end_row, std::uint8_t *pixels);

} // namespace gradus
