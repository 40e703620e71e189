// Screened Poisson reconstruction: the image whose differences are nearest to given ones, and which is near to a given
// image. A library of its own: it needs an OpenCL device and knows nothing of scenes or renderers.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/device.h"
#include "runtime/device/precision.h"
#include "solver/kernel_times.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gradus {

enum class PoissonNorm {
    l1, ///< sum |Dx I - Gx| + sum |Dy I - Gy| + alpha sum |I - I0|, |.| over the channels of a pixel; robust
    l2  ///< ||Dx I - Gx||^2 + ||Dy I - Gy||^2 + alpha^2 ||I - I0||^2; linear, so unbiased where its inputs are
};

enum class LinearMethod {
    automatic, ///< multigrid for uniform weights, pcg for others
    jacobi,
    cg,
    pcg,      ///< conjugate gradients preconditioned by a multigrid cycle
    multigrid ///< cycles on their own
};

/// Planes of an image: channel c at row y and column x is element (c * height + y) * width + x, 32-bit float.
/// `Planes` is `const float *` (host) or `const Buffer *` (device). Those that are left null are not there.
template <class Planes>
struct PoissonImages {
    Planes primal{}; ///< I0
    Planes dx{};     ///< Gx(x, y), an estimate of I(x + 1, y) - I(x, y); the last column is not read
    Planes dy{};     ///< Gy(x, y), an estimate of I(x, y + 1) - I(x, y); the last row is not read
    Planes direct{}; ///< added to the reconstruction as it is
    Planes start{};  ///< where the iteration starts, else at or near I0; for L1 only where its norm is less than there
    /// Variances of primal, dx and dy, by pixel and channel: read where an option asks for them, and then all three.
    Planes primal_variance{}, dx_variance{}, dy_variance{};
    /// Of BufferSources: the variances have one plane, for all channels.
    bool one_variance = false;
};
using HostImages = PoissonImages<const float *>;
using DeviceImages = PoissonImages<const Buffer *>;
/// Writes height * width floats: a channel of an image. Is asked for each channel, one after the other.
using PlaneSource = std::function<void(std::uint32_t channel, float *plane)>;
/// Images that are made when they are asked for, and are never in memory as a whole.
using ImageSources = PoissonImages<PlaneSource>;
/// Images in device memory that are made when they are asked for; each until the next is.
using BufferSources = PoissonImages<std::function<const Buffer &()>>;
/// Takes a channel of the result.
using PlaneSink = std::function<void(std::uint32_t channel, const float *plane)>;

/// With a smaller alpha, but for 0, the L1 norm's data terms are lost in single precision's rounding beside its
/// differences: in images of 16 x 16 to 512 x 512, 1e-5 is off by up to 0.15 and 1e-6 by ten.
inline constexpr double least_alpha_of_absolute_values = 1e-4;

/// What a larger alpha counts as: nothing is left of the differences in any precision. Squares, times the sizes of
/// coarse pixels, are to be numbers.
inline constexpr double largest_alpha = 1e12;

/// The same of the L2 norm where anything is missing or weighed. There differences take a pixel some 1e-4 of what they
/// ask for away from its datum, while larger weights of data beside pixels without any are more than preconditioned
/// steps can bridge: with 300 some small images do not converge, with 1000 every third, and with 1e8 pixels without
/// data are off by up to 1e12.
inline constexpr double largest_alpha_of_weights = 100;

struct PoissonOptions {
    PoissonNorm norm = PoissonNorm::l1;
    /// 0 or above; with L1 0, or at least least_alpha_of_absolute_values. With 0, I0 decides the mean of each
    /// channel and nothing else.
    double alpha = 0.2;
    /// alpha^2 = (variance of dx and dy) / (variance of primal) instead (Kettunen et al. 2015, supplement, eq. 12), of
    /// L2 the means; of L1 and of weights (mean of fourth roots)^4, so that a firefly is not all of it. Needs the
    /// variances; where all are 0, as of one sample, they tell nothing and `alpha` stands.
    bool alpha_from_variances = false;
    /// L2: each equation is weighted by its inverse variance, relative to the scale of its image's, instead of equally
    /// (after Rousselle et al. 2016). Needs the variances. The mean of I0 is then not kept.
    bool weigh_by_variance = false;
    /// Then an equation with a variance far below that scale still counts no more than so many times as much as at it.
    /// 1 to 1e9.
    double largest_weight = 100;
    LinearMethod method = LinearMethod::automatic;
    /// L2: the relative residual ||b - A u|| / ||b|| of the system for u = I - I0 at which to stop. L1: the relative
    /// decrease of the objective from one reweighting to the next. 0: 1e-5 and 1e-4. At least the rounding error.
    double tolerance = 0;
    /// L2 weighted by variance, with alpha from variances and preconditioned conjugate gradients: stop where the error
    /// is below so much of the solution's noise instead, both squared and in the norm of the equations, <e, A e>: with
    /// weights by inverse variance, noise has as much of that as the image has pixels. 0, or where nothing is noisy: by
    /// `tolerance`.
    double noise_share = 0;
    /// At most so many: steps or cycles (L2), reweightings (L1). 0: enough to reach the tolerance where the method can.
    int iterations = 0;
    /// Steps of the inner solver for each reweighting (L1).
    int inner_iterations = 2;
    /// Jacobi's step; 1 is the plain method. Above 0 and at most 1.
    double damping = 1;
    /// One weight for all channels of a pixel (true), or one for each. L1: |.| is then the sum of absolute values. L2
    /// weighted by variance: one weight goes by the mean variance of the channels.
    bool joint_channels = true;
    /// L1: adds a smooth image that brings local means back to those of I0 (mean_correction.h).
    bool keep_mean = true;

    bool operator==(const PoissonOptions &) const = default;
};

/// The method of a report on images without differences, of which there is no system to solve.
constexpr const char *no_system = "none";

struct PoissonReport {
    std::string method; ///< "multigrid", or "irls, pcg" and the like; or no_system
    double alpha = 0;   ///< as used: at most 1e12; of L2 where anything is missing or weighed, 0 or 1e-4 to 100
    int iterations = 0; ///< steps or cycles in all
    int reweightings = 0;
    bool converged = false; ///< the tolerance was reached
    /// Relative, over all channels: at the start and after each step (L2); with noise_share, the root of the error
    /// over the noise, before each step.
    std::vector<double> residuals;
    std::vector<double> objectives; ///< of the L1 norm, before each reweighting and at the end, without the correction
    double objective = 0;           ///< of the norm that was asked for, at the end, without the correction
    /// Pixels of each input with a NaN or an infinity in any channel, which were treated as missing.
    std::uint64_t missing_primal = 0, missing_dx = 0, missing_dy = 0;
    std::uint64_t filled = 0;       ///< pixels without any valid input, which took the mean of their neighbours
    std::vector<double> correction; ///< mean of the correction, by channel (L1 with keep_mean)
    double seconds = 0;             ///< wall time
    std::uint64_t device_bytes = 0; ///< the most that was allocated on the device at one time
    std::vector<KernelTime> kernels;
};

/// Solves problems of one size on one device. Buffers and kernels are made once and used again; after an error, anew.
///
/// The system is solved for I - I0, which avoids cancellation. L2 with uniform weights keeps the mean of each channel
/// of I0. Sums have a fixed order: equal inputs give equal bits on one device.
class PoissonSolver {
  public:
    /// Throws Error(ExitCode::usage) for a size or channel count of 0 (or over 8 channels). `together`: how many
    /// channels the linear systems are solved for at a time; 0: one on a CPU, but for small images, and where memory is
    /// short, else all. The result is the same; memory is not. Buffers are made in the first solve.
    PoissonSolver(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels = 3,
                  Precision precision = Precision::single, std::uint32_t together = 0);
    ~PoissonSolver();
    PoissonSolver(const PoissonSolver &) = delete;
    PoissonSolver &operator=(const PoissonSolver &) = delete;

    /// Writes channels * height * width floats to `result`. Throws Error(ExitCode::usage) for options out of their
    /// range, variances that are needed and missing, or images that are missing.
    PoissonReport solve(const HostImages &images, const PoissonOptions &options, float *result);
    /// The same from images that are made under way: primal, dx, dy, and where options ask for them the variances are
    /// each read once, then `all_read` is called; start and direct are read after that. So what they are made from may
    /// go before most of the solver's memory is needed.
    PoissonReport solve(const ImageSources &images, const PoissonOptions &options, const PlaneSink &result,
                        const std::function<void()> &all_read = {});
    /// The same in device memory; `result` may be one of the inputs. Throws Error(ExitCode::device) where the device
    /// has no room.
    PoissonReport solve(const DeviceImages &images, const PoissonOptions &options, Buffer &result);
    /// The same from images that are made under way; each is asked for once.
    PoissonReport solve(const BufferSources &images, const PoissonOptions &options, Buffer &result);

    std::uint32_t width() const;
    std::uint32_t height() const;
    std::uint32_t channels() const;

    /// Compiles the kernels of a solve, so that the first one finds them. Uses no queue, so another thread may do it
    /// while this one works on the device. `progress`: called after each kernel, with its name, how many are there, of
    /// how many, and the seconds that it took; what it throws ends this.
    static void
    compile(Device &device, const PoissonOptions &options, std::uint32_t channels = 3,
            Precision precision = Precision::single,
            const std::function<void(const std::string &, std::size_t, std::size_t, double)> &progress = {});

    struct Implementation;

  private:
    /// What `solve` returns of the implementation. Where that throws, what is made so far may be half of itself, and
    /// goes.
    PoissonReport run(const std::function<PoissonReport(Implementation &)> &solve);

    std::function<std::unique_ptr<Implementation>()> make_;
    std::unique_ptr<Implementation> implementation_; ///< nullptr after an error
    std::uint32_t width_, height_, channels_;
};

const char *method_name(LinearMethod method);

} // namespace gradus
