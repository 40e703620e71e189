// An unbiased reconstruction with weights of their own for each pixel and each difference.
//
// Least squares with weights by inverse variance have the least error, but variances of the same samples bias them: of
// skewed noise what is too dark also looks too sure. So each half of the samples is solved for with the other's
// variances, which know nothing of its noise. Whatever the weights, the solution is linear in the half's images, so its
// mean is right, and so is that of both halves. The halves may share what all pixels of a sample share, the places
// within pixels: given these, a half's images agree on average with one image, which any weights leave as it is.
// (Rousselle et al. 2016 weigh by the variances of the samples
// themselves.)
#pragma once

#include "runtime/device/program.h"
#include "solver/grid.h"
#include "solver/halves.h"
#include "solver/poisson_solver.h"
#include "solver/squared_errors.h"

namespace gradus {

/// Makes variances fit to be weights.
class VarianceSmoother {
  public:
    /// `channels`: of the images.
    VarianceSmoother(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels);

    /// Of pixels, or of differences, which the last column or row has not.
    enum class Differences { none, right, down };
    /// What follows is of this half.
    void begin(const HalfImages &judge);
    /// The variances of one of its images, smoothed over the neighbourhood (kernels/solver/smooth_variance.cl), at
    /// least a share of the squared brightness there: one plane, for all channels. -1 where there are none. The buffer
    /// is used again by the next call.
    const Buffer &smoothed(const Buffer &variance, Differences differences);

    std::vector<Kernel *> kernels() { return {&mean_, &smooth_, &smooth_and_add_, &finish_}; }

    /// How far a pixel's neighbours are, and how much they count, from each smoothing to the next.
    struct Smoothing {
        std::uint32_t apart;
        double side;
    };

  private:
    /// How many columns and rows an image has.
    struct Extent {
        std::uint32_t columns, rows;
    };
    void allocate();
    void launch(Kernel &kernel, Extent extent);
    void take_mean(const Buffer &image, bool is_variance, Extent extent);
    void smooth(Kernel &kernel, Smoothing smoothing, Extent extent);

    Device &device_;
    solver::Grid grid_;
    double samples_ = 0; ///< of a pixel
    Kernel mean_, smooth_, smooth_and_add_, finish_;
    Buffer image_, other_, brightness_, logarithms_, smoothed_;
};

/// Sums of images, value by value.
class ImageMixer {
  public:
    explicit ImageMixer(Device &device);
    /// `result` = a first + b second; it may be one of them.
    void mix(const Buffer &first, double a, const Buffer &second, double b, Buffer &result);

  private:
    Kernel mix_;
};

class WeightedReconstruction {
  public:
    /// For images of the solver's size, which is the caller's and must live as long.
    WeightedReconstruction(Device &device, PoissonSolver &solver);

    /// Writes the solution of one half to `result`, with the variances of `judge`. Unbiased where the two halves are
    /// independent.
    PoissonReport solve_half(const HalfImages &half, const HalfImages &judge, Buffer &result);
    /// Writes the mean of both halves' solutions, by their samples, to `result`, which has as many values as their
    /// primal. The report is that of both solves.
    /// `errors`: gets what the halves tell of the image's error.
    PoissonReport solve(const HalvedImages &halves, Buffer &result, SquaredErrors *errors = nullptr);

    /// The same without the mean: the solution of each half.
    PoissonReport solve_both(const HalvedImages &halves, std::array<Buffer, 2> &results);

    /// What a half asks of the solver.
    static PoissonOptions options();
    /// As PoissonSolver::compile().
    static void compile(Device &device, std::uint32_t channels = 3, const KernelLibrary::Progress &progress = {});

  private:
    Device &device_;
    PoissonSolver &solver_;
    VarianceSmoother smoother_;
    ImageMixer mixer_;
};

/// The same from images on the host: writes channels * height * width floats to `result`.
PoissonReport solve_weighted(Device &device, PoissonSolver &solver, const HostHalves &halves, float *result);

} // namespace gradus
