// The memory bandwidth that the processor's cores reach together.
#pragma once

#include <cstddef>

namespace gradus::bench {

/// Bytes per second of a[i] = b[i] + s c[i] (the triad of McCalpin's STREAM), 12 bytes an element, over three arrays
/// that hold `total_bytes` together. The median of several rounds.
double triad_bandwidth(std::size_t total_bytes, int threads);

} // namespace gradus::bench
