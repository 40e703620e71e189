#include "runtime/trace/ray_packets.h"

#include "runtime/trace/clones.h"

namespace gradus {

namespace {

/// One column. Nothing overlaps, which the compiler must know to store the lanes as one vector.
__attribute__((always_inline)) inline void gather(const float *__restrict column, const std::uint32_t *__restrict rows,
                                                  float *__restrict lanes) {
    for (int lane = 0; lane < packet_width; ++lane)
        lanes[lane] = column[rows[lane]];
}

} // namespace

GRADUS_CLONES void gather_segments(const SegmentColumns &rays, const std::uint32_t *rows, const SegmentLanes &lanes) {
    for (int axis = 0; axis < 3; ++axis) {
        gather(rays.origin[axis], rows, lanes.origin[axis]);
        gather(rays.direction[axis], rows, lanes.direction[axis]);
    }
}

} // namespace gradus
