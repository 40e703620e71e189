// A short render before a render: of pairs of rows all over the image, with gradient-domain path tracing. It tells what
// that and path tracing cost, how noisy samples are, and how noisy differences are beside them.
//
// Its samples are not in the image: an image that decided on its own method would be biased. So it is a few hundredths
// of the render, and most of that is what launching kernels takes at all.
#pragma once

#include "methods/gradient_path_tracer.h"

#include <cstdint>

namespace gradus {

/// Samples a pixel of the pilot's rows.
constexpr std::uint64_t pilot_samples = 8;

/// What a sample costs, in rays of a path tracer (row_pilot.cpp). Counted, never timed, so that a choice by it is the
/// same on each run and on each machine.
struct PathCosts {
    double pt = 0, gpt = 0;
};

struct RowPilot {
    double error = 0; ///< relMSE of an image of one sample a pixel by path tracing
    /// Which part of it least squares leave that know all variances, within blocks of the pilot's rows.
    double left = 1;
    PathCosts costs;
    double seconds = 0; ///< rendering, kernels compiled
};

/// Which part of the variance of pixels least squares leave where all pixels have one variance, all differences to the
/// right another and all differences down a third: `across` and `down` are the variance of a pixel over theirs. It is
/// the mean over frequencies (k, l) of 1 / (1 + across (2 - 2 cos k) + down (2 - 2 cos l)).
double part_left(double across, double down);

/// How many rows the pilot of such a render has; 0: there are none, or `must` is false and there is no room for them.
std::uint32_t rows_of_pilot(std::uint32_t width, std::uint32_t height, std::uint64_t samples_per_pixel,
                            bool must = false);

/// The same of a render until a time, which is not to lose much of that.
std::uint32_t rows_of_timed_pilot(std::uint32_t width, std::uint32_t height);

/// Samples a pixel that gpt takes in so many seconds, by the time that a pilot of some of the image's rows took: fewer
/// than in truth where launches are most of that, as in small images.
std::uint64_t samples_within(double seconds, const RowPilot &pilot, std::uint32_t rows, std::uint32_t height);

/// Renders so many rows with `method`, which is to be restarted afterwards. Its samples have numbers that no render
/// reaches.
RowPilot run_row_pilot(GradientPathTracer &method, std::uint32_t rows);

} // namespace gradus
