// Hands tables of rays and segments to the tracer.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/host_memory.h"
#include "runtime/device/precision.h"
#include "runtime/trace/tracer.h"

#include <cstdint>
#include <limits>
#include <memory>

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
    int instance = -1;           ///< the column of the second answer, where there are instances: RayColumns::instance
    int opacity = -1;            ///< that of the third, where it is asked for: RayColumns::opacity
    bool without_chance = false; ///< RayColumns::without_chance
};

/// What Session hands tables to its tracer by.
class SegmentTracer {
  public:
    /// The device and the tracer must outlive this.
    SegmentTracer(Device &device, Tracer &tracer, Precision precision);
    SegmentTracer(const SegmentTracer &) = delete;
    SegmentTracer &operator=(const SegmentTracer &) = delete;

    /// Finds what `rays` meet first (their answers: ray_pending before, a primitive or ray_escaped after), and whether
    /// nothing lies within `segments` (1 before, 1 or 0 after). Waits for the device first; a device that is the host
    /// does nothing while the tracer works, so that the two never compete for cores. Rays of a double table are rounded
    /// to float, in which Embree traces; kernels compute hits from the double ones.
    TraceCounts trace(const SegmentTable &rays, const SegmentTable &segments);

    double seconds = 0; ///< that the tracer alone took so far

  private:
    Device &device_;
    Tracer &tracer_;
    Precision precision_;
    /// Of devices that have memory of their own: what the tables' columns are copied through.
    std::unique_ptr<HostMemory> ray_copy_, segment_copy_;
};

} // namespace gradus
