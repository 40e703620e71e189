// A consistent reconstruction of two halves with a guide image, which counts as far as it is right by place.
#pragma once

#include "solver/guide/denoiser.h"
#include "solver/guide/feature_filter.h"
#include "solver/guide/guide_judge.h"
#include "solver/guide/light_correction.h"
#include "solver/reconstruction.h"
#include "solver/squared_errors.h"
#include "solver/weighted_reconstruction.h"

#include <memory>

namespace gradus {

/// What a guide is made of beside the halves.
struct GuideInputs {
    /// Seven planes: albedo, normal and depth.
    Buffer features;
    /// Three planes that are added to the result at last, as light that is seen without noise is; none: nothing. A
    /// denoiser sees them.
    Buffer direct;
};

class GuidedReconstruction {
  public:
    /// For images of three channels of the solver's size, which is the caller's and must live as long. Throws as
    /// Denoiser does where the guide is one, which then takes `threads`; 0: all.
    GuidedReconstruction(Device &device, PoissonSolver &solver, Guide guide, int threads);

    /// Writes the image, without `direct`, to `result`, which has as many values as the halves' primal. Halves without
    /// differences are their primal, and no solver is asked. The report is that of the solves.
    /// `errors`: gets what the halves tell of the image's error.
    PoissonReport solve(const HalvedImages &halves, const GuideInputs &inputs, Buffer &result,
                        SquaredErrors *errors = nullptr);

    /// As PoissonSolver::compile().
    static void compile(Device &device, const KernelLibrary::Progress &progress = {});

  private:
    /// The mean of the denoised primal, whose noise is of each pixel alone, and of the denoised solution, which has
    /// less of it: what is wrong with either differs. Without a solution it is that of the primal.
    void denoise(const Buffer &primal, const Buffer *solution, const Buffer &direct, const Denoiser::Features &features,
                 Buffer &guide);

    Device &device_;
    PoissonSolver &solver_;
    std::unique_ptr<Denoiser> denoiser_;
    std::unique_ptr<FeatureFilter> filter_;
    GuideJudge judge_;
    LightCorrection light_;
};

/// GuideInputs in memory of the host: planes of width * height floats, three of albedo and of the normal, one of depth,
/// three of `direct`, which may be null.
struct HostGuideInputs {
    const float *albedo = nullptr, *normal = nullptr, *depth = nullptr, *direct = nullptr;
};

/// The same from images on the host: writes 3 * height * width floats to `result`, without `direct`.
PoissonReport solve_guided(Device &device, PoissonSolver &solver, const HostHalves &halves,
                           const HostGuideInputs &inputs, Guide guide, int threads, float *result);

} // namespace gradus
