// Gradient-domain images against references of another renderer.
#pragma once

#include "planning/make_method.h"
#include "tests/methods/reference_scene.h"

#include <vector>

namespace gradus::testing {

/// Expects that the primals and the differences of `images`, of independent seeds and with their layers, have the means
/// that a reference says, block by block. `options`: what decides what paths there are; the signs of differences are
/// told by path tracing with it. Returns the largest score of a block over its limit.
/// Also plants shares by which primals or differences are too small, from the smallest on, and prints the first that
/// would be seen. Calm blocks show it; those of light found by chance may bear more, and where all light is such, a
/// test may be blunt.
double expect_gradients(const ReferenceScene &reference, const std::vector<Image> &images, double samples_per_pixel,
                        RenderOptions options = {}, const std::vector<double> &planted = {});

/// Expects that reconstructions lose no light, a hundredth of the primals' mean at most (they are unbiased, but not
/// each of the primal's mean: where rare bright samples make it, four standard errors over the seeds are more), and
/// returns their relMSE over that of their primals.
double noise_left_by_reconstruction(const ReferenceScene &reference, const std::vector<Image> &images);

/// Cuts a reference and its scene down to a part of the film, in pixels.
void crop(ReferenceScene &reference, std::uint32_t x, std::uint32_t y, std::uint32_t width, std::uint32_t height);

} // namespace gradus::testing
