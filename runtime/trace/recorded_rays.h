// Packets of a render, kept as they were traced, so that tracing alone can be timed again.
#pragma once

#include "runtime/trace/embree.h"

#include <cstdint>
#include <vector>

namespace gradus {

struct RecordedRays {
    std::vector<RTCRayHit16> extension;
    std::vector<RTCRay16> shadow;
    std::vector<int> extension_lanes, shadow_lanes; ///< how many lanes of each packet are rays
    bool of_camera = false;

    std::uint64_t count() const;
};

/// Traces the packets, or (`single`) their rays one by one.
void trace_again(RTCScene scene, const RecordedRays &rays, bool extension_beams, bool shadow_beams, bool single);

} // namespace gradus
