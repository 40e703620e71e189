// Two short renders before a render, which photons are compared with (photon_pilot.h): independent images of
// gradient-domain path tracing, with what they were made from. Their samples are not in the image: an image that
// decided on its own method would be biased.
#pragma once

#include "methods/gradient_path_tracer.h"
#include "runtime/film/image.h"

#include <array>
#include <cstdint>
#include <vector>

namespace gradus {

/// Samples a pixel of a half. Fewer make gpt look worse than it is: all its pixels share their place within the pixel,
/// and edges are as jagged as those places are few.
constexpr std::uint64_t half_samples = 4;

/// Errors of images of as many samples as one half of the pilot has.
struct PilotErrors {
    double pt = 0, gpt = 0; ///< relMSE
};

/// Pairs of independent images whose means, freed of single outliers, stand for the reference that there is not: where
/// there are several, the largest, for of what one does not see it would be no measure.
using ReferencePairs = std::vector<std::array<const Image *, 2>>;
/// By pixel: 1 over the square of that reference and relMSE's epsilon.
std::vector<double> relative_weights(const ReferencePairs &references, const char *color);

/// From two images of gpt of independent samples: W its means without reconstruction, which are images of pt, and R
/// reconstructed. Without a reference,
///   relMSE of W: half of (W_1 - W_2)^2,
///   relMSE of R: half of (R_1 - R_2)^2, its variance, plus (R_1 - W_1) (R_2 - W_2), the square of its bias,
/// relative to the mean of R_1 and R_2 in place of the reference, freed of single outliers: a firefly that were part of
/// its own reference would weigh little. W has no bias, so R - W has that of R, and two
/// independent halves make its square without bias. What the reconstruction of both halves gets wrong in the same way
/// (L1 where noise is skewed, blurred detail) counts by that. All are means over pixels and channels R, G, B.
PilotErrors estimate_errors(const Image &first, const Image &second);
/// The same relative to others than R_1 and R_2.
PilotErrors estimate_errors(const Image &first, const Image &second, const ReferencePairs &references);

struct Pilot {
    double seconds = 0;          ///< rendering, kernels compiled; without the reconstructions
    std::array<Image, 2> halves; ///< with layers
};

/// Whether a render of so many samples a pixel is so long that both halves are at most a tenth of it.
bool has_room_for_halves(std::uint64_t samples_per_pixel);

/// Renders both halves with `method`, which is to be restarted afterwards. Their samples have numbers that no render
/// reaches.
Pilot run_pilot(GradientPathTracer &method);

} // namespace gradus
