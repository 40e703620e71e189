// The measurements of gradus-bench-solver, one file each. Each prints its table and returns the same as JSON. What is
// compared takes turns (A B A B), so that a machine that slows down slows both; medians over the turns count.
#pragma once

#include "bench/solver/problem.h"

namespace gradus::bench {

/// Error against time for each method at one size, L2 and L1.
nlohmann::json measure_curves(const Settings &settings, Problem &problem);

/// L2 to a relative residual of 1e-4, against FFTW; and 50 steps of conjugate gradients.
nlohmann::json measure_direct_rival(const Settings &settings, Problem &problem);

/// Both halves of a render, each weighted by the other's variances, against FFTW's uniform solve of one half and
/// against L1 with default options.
nlohmann::json measure_weighted(const Settings &settings, std::uint32_t width, std::uint32_t height);

/// What a step of conjugate gradients moves in memory, against a triad.
nlohmann::json measure_bandwidth(const Settings &settings, Problem &problem);

/// L1 with default options against 20 reweightings of 50 steps of conjugate gradients.
nlohmann::json measure_l1(const Settings &settings, Problem &problem);

/// Seconds per pixel from 1 to 16 million pixels; `quick`: up to 4 million.
nlohmann::json measure_scaling(const Settings &settings, bool quick);

} // namespace gradus::bench
