// The error of an image that follows a guide, from the same halves by which the guide was judged (guide_judge.h).
//
// With the notation there, the image is U + s (b - U). For a given s its noise is that of (1 - s) U + s b, and p q
// times the squared difference of what that makes of either half is its variance. Its bias is s times the guide's:
// U has none, so (b - U)^2 has the square of the guide's bias and the variance of b - U as its mean, and the latter is
// told by the halves: p q ((b_A - U_A) - (b_B - U_B))^2. Together
//     (1 - s)^2 var U + 2 s (1 - s) cov(U, b) + s^2 E(b - truth)^2 = var U - 2 s gain + s^2 (gain + loss),
// which is var U - s gain for the best s.
//
// What this does not know is what s and the guide's weights have of the noise of both halves. s is made of some hundred
// pixels, of which each is a small part. But weights that choose among neighbours make the guide follow the image,
// which then seems to have less than no bias (methods/error_layer.h).
#pragma once

#include "runtime/device/buffer.h"
#include "solver/squared_errors.h"

#include <array>

namespace gradus {

/// `followed`: the share of the guide by pixel, s. Where a guide is made of all samples the halves' own stand for it,
/// which have a little more error.
SquaredErrors errors_of_guided(const std::array<const Buffer *, 2> &halves, double share,
                               const std::array<const Buffer *, 2> &guides, const std::vector<float> &followed);

} // namespace gradus
