// Hands the ray and shadow tables of a batch to the tracer.
#pragma once

#include "runtime/stages/batch_tables.h"
#include "runtime/trace/tracer.h"

namespace gradus {

/// Traces the first `rays` rows of tables.ray and the first `shadows` rows of tables.shadow. Waits for the device
/// first; the device does nothing while the host traces, so that the two never compete for cores. Rays of a double
/// table are rounded to float, in which Embree traces; kernels compute hits from the double ones. `trace_seconds` grows
/// by the tracer's time alone.
TraceCounts run_trace_stage(Tracer &tracer, const BatchTables &tables, std::uint32_t rays, std::uint32_t shadows,
                            double &trace_seconds);

/// What offset paths ask: the first `links` rows of a table of links (GRADUS_LINK_COLUMNS, 8 * capacity rows) and the
/// first `rays` of one of rays (GRADUS_OFFSET_RAY_COLUMNS, 4 * capacity rows), where there is one. Returns how many
/// were traced.
std::uint64_t run_offset_stage(Tracer &tracer, const Buffer &link, std::uint32_t links, const Buffer *offset_ray,
                               std::uint32_t rays, std::uint32_t capacity, Precision precision, double &trace_seconds);

} // namespace gradus
