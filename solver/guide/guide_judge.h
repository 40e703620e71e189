// How far an image follows its guide, by place: as far as lessens its error, by what two halves of the samples say.
//
// U is the mean of two independent unbiased images U_A and U_B of the halves, which have the shares p and q of the
// samples; b that of guides b_A and b_B, each made of its half. The share s of U + s (b - U) with the least mean square
// error is
//     s = gain / (gain + loss),   gain = var U - cov(U, b),   loss = E(b - truth)^2 - cov(U, b),
// and both are measured: p q (U_A - U_B) ((U_A - U_B) - (b_A - b_B)) is gain on average, and (b - U)^2 is gain + loss.
// So the guide's bias counts in full, whatever it comes from, without a reference: it is what b and U differ by beyond
// their noise. Both are means over a few pixels, relative to brightness. A loss counts as far as it is more than one
// standard error above zero: below that, following U would bring its noise for nothing that could be seen.
//
// As samples grow, gain falls as their inverse while the loss stays the guide's squared bias: so s does, and so does
// what the guide's bias adds to the image. The image is consistent, and its error falls as that of U at last.
//
// It is a filter on images, after the solver: as a third kind of equation in the solve the same guides gave 1.1 to
// 2.8 times the squared error, since a guide's errors go together from pixel to pixel, which equations take for
// independent.
#pragma once

#include "solver/guide/guide_smoother.h"

#include <array>
#include <vector>

namespace gradus {

class GuideJudge {
  public:
    /// Throws Error(ExitCode::usage) for a size of 0.
    GuideJudge(Device &device, std::uint32_t width, std::uint32_t height, Precision precision = Precision::single);

    /// Writes the image that follows `guides` as far as they are right to `result`, which may be one of the images.
    /// All are of three channels, planes as PoissonImages has them. `share`: of the samples that the first half has.
    /// A pixel whose halves are not finite follows the guide, one whose guide is not finite the halves.
    /// `followed`: the guide that is followed instead of the mean of both, made of all samples as they are of halves.
    /// `kept`: gets the share of the guide by pixel, where both images are there.
    void run(const std::array<const Buffer *, 2> &halves, double share, const std::array<const Buffer *, 2> &guides,
             Buffer &result, const Buffer *followed = nullptr, std::vector<float> *kept = nullptr);

  private:
    template <class Real>
    std::vector<float> quotients_inside(const Buffer &planes) const;

    const solver::PlaneMaker make_;
    const solver::Grid grid_;
    Kernel moments_, share_, blend_;
    solver::GuideSmoother wide_, narrow_;
};

} // namespace gradus
