// Pixel filters with negative lobes, as tables to draw from.
#pragma once

#include "runtime/scene/scene.h"

#include <vector>

namespace gradus {

/// Whether the filter is drawn from by a table, since it has negative lobes.
bool is_signed(FilmSettings::Filter filter);

/// Of such a filter, at `x` pixels from its center along one axis; not normalised.
double signed_filter(const FilmSettings &film, double x);

/// The table of kernels/lib/filter_table.h; empty of filters without negative lobes. Each lobe has cells for its own,
/// so that the sign is one of a cell, and at a cell's borders the table's integrals are the filter's.
std::vector<float> make_filter_table(const FilmSettings &film);

} // namespace gradus
