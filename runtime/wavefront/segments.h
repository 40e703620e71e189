// Hands tables of rays and segments to the tracer.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/precision.h"
#include "runtime/trace/tracer.h"

#include <cstdint>
#include <limits>

namespace gradus {

/// The first `count` rows of a table that has, among its columns, the origin and the direction of a segment and a place
/// for the tracer's answer.
struct SegmentTable {
    const Buffer *table = nullptr; ///< null: none
    std::size_t rows = 0;          ///< of the table: how far its columns are apart
    std::uint32_t count = 0;
    int origin = 0, direction = 0, answer = 0; ///< the columns: the first of three, of three, the only one
    std::uint32_t line = 0;                    ///< SegmentColumns::line
    /// SegmentColumns::alike_from
    std::size_t alike_from = std::numeric_limits<std::size_t>::max();
    int instance = -1; ///< the column of the second answer, where there are instances: RayColumns::instance
    int opacity = -1;  ///< that of the third, where it is asked for: RayColumns::opacity
};

/// Finds what `rays` meet first (their answers: ray_pending before, a primitive or ray_escaped after), and whether
/// nothing lies within `segments` (1 before, 1 or 0 after). Waits for the device first; the device does nothing while
/// the host traces, so that the two never compete for cores. Rays of a double table are rounded to float, in which
/// Embree traces; kernels compute hits from the double ones. `seconds` grows by the tracer's time alone.
TraceCounts trace_segments(Tracer &tracer, Precision precision, const SegmentTable &rays, const SegmentTable &segments,
                           double &seconds);

} // namespace gradus
