// Values for pixels that have none of their own: the mean of their neighbours, ring by ring.
#pragma once

#include "solver/grid.h"

namespace gradus::solver {

/// Gives every pixel of `image`, of so many channels, whose `valid` is 0 the mean of its valid neighbours, then those
/// next to them, and so on; all stay as they are where no pixel is valid. `valid` is 0 or 1 by pixel and is kept. On
/// the host, which goes from ring to ring; a device would go through the whole image for each.
void fill_missing(Precision precision, const Grid &grid, std::uint32_t channels, const Buffer &valid, Buffer &image);

} // namespace gradus::solver
