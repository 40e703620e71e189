// Where within their pixels the samples of a frame lie, where all pixels share that place, as the stage `camera` draws
// it: what stages need to know where the filter reaches beyond the pixel (kernels/lib/filter_frame.h).
#pragma once

#include "runtime/wavefront/session.h"

#include <cstdint>

namespace gradus {

/// Along both axes, as filter_number() has it.
struct FramePlace {
    std::uint32_t x = 0, y = 0;
};

/// `frame`: its number, by which random numbers go.
FramePlace frame_place(const Session &session, std::uint64_t frame);
/// Of samples that count for their own pixels alone, wherever they lie.
FramePlace place_of_own();

} // namespace gradus
