// The system for u = I - I0, made from the caller's images.
#pragma once

#include "solver/fill.h"
#include "solver/poisson_solver.h"
#include "solver/workspace.h"

#include <functional>

namespace gradus::solver {

/// The caller's images, each in device memory from the call on until another is called. `Problem` calls each once.
using Inputs = BufferSources;

class Problem {
  public:
    explicit Problem(Workspace &workspace);

    /// Reads I0, Gx and Gy. What is NaN or infinite is missing: I0 is filled from its neighbours there, and counted.
    void import(const Inputs &images, PoissonReport &report);
    /// Reads the variances for their scales, and keeps them for weights. A variance that is missing or below zero
    /// removes its equation from weighted problems. Of uniform L2 their scale is the mean (Kettunen et al. 2015,
    /// supplement), which tells its squared error. Else it is (mean of fourth roots)^4, for a firefly is most of a
    /// mean: all that is less noisy than a thousandth of it would weigh alike, and L1, which leaves outliers where they
    /// are, would go by them (docs/design.md, 'Reconstruction').
    void import_variances(const Inputs &images, const PoissonOptions &options);
    /// Kettunen et al. 2015, supplement, eq. 12; `otherwise` where all variances are 0.
    double alpha_from_variances(double otherwise) const;
    /// With that alpha, and weights by variance: what the noise of a channel of the solution is expected to have of
    /// <e, A e>. The weights are gradient_variance_scale_ / variance, and the inverse of A times that is its
    /// covariance.
    double noise() const { return gradient_variance_scale_ * workspace_.grid().width * workspace_.grid().height; }

    bool anything_missing() const { return anything_missing_; }
    /// Weights of the equations before any norm: 0 for what is missing, else 1 or by inverse variance, at most
    /// `largest_weight` times that of the variances' scale.
    void make_base_weights(Kernels &kernels, bool by_variance, double largest_weight = 1);
    /// Sets the finest system to the base weights, those of the data term times alpha^2.
    void use_least_squares_weights(Kernels &kernels, double alpha);
    /// The right side of a group of channels for the weights of the finest system.
    const Buffer &make_right_side(Kernels &kernels, Planes group);
    /// u = start - I0, or 0.
    void start(const Inputs &images);
    /// u = 0, cut to what the differences give from the neighbours: an outlier of I0 does not stay, right or wrong.
    void start_between_neighbours(Kernels &kernels);
    /// Takes the mean of u off: uniform weights keep that of I0.
    void remove_mean(Kernels &kernels);
    /// The squared norm that the weights of the finest system give u.
    double squared_norm(Kernels &kernels);

    /// ||b||, but at least a millionth of ||I0||: less is the rounding of I0's differences.
    double norm_of_right_side(Kernels &kernels);

    /// Notes which pixels the weights of the finest system hold. compose() does it where nothing did since import().
    void find_held(Kernels &kernels);
    /// Writes I0 + u (+ direct). With `keep_mean`, u's mean is taken off first. Pixels that no equation holds take the
    /// mean of their neighbours; returns their number.
    std::uint64_t compose(Kernels &kernels, const Inputs &images, bool keep_mean, Buffer &result);

    const Buffer &valid_primal() const { return valid_primal_; }
    const Buffer &base() const { return base_; }
    /// The base weights of the data terms, once they are made.
    const Buffer &base_data() const { return base_data_; }
    Buffer &u() { return u_; }
    /// Binds gradient_x, gradient_y and the base weights.
    void bind(Kernel &kernel) const;

    // Memory that is used again, so that a large image fits.
    /// A plane for each channel that nothing else needs between import and compose, whatever they hold, borders too.
    Buffer &spare();
    /// The gradients: no longer needed once find_held() has been called for the L1 norm. Borders are zero.
    Buffer &gradient_x() { return gradient_x_; }
    Buffer &gradient_y() { return gradient_y_; }
    /// Where make_right_side() writes.
    const Buffer &right_side();

  private:
    /// Launches kernel import_image or import_variance on one plane.
    void import_plane(Kernel &kernel, std::uint32_t plane, const Buffer &packed, const Buffer &imported,
                      std::uint32_t columns, std::uint32_t rows);
    /// Returns how many pixels or differences are missing.
    double import_image(const Buffer &packed, const Buffer &imported, const Buffer &valid, std::uint32_t columns,
                        std::uint32_t rows);
    /// Of those that are there, or of their fourth roots.
    double mean_variance(const Buffer &packed, std::uint32_t planes, const Buffer &variance, std::uint32_t columns,
                         std::uint32_t rows, bool of_roots);
    /// u += image - the sum in slot_mean times mean_factor.
    void add_to_u(Kernels &kernels, const Buffer &image, double mean_factor);
    const Buffer &zero();

    void allocate();

    Workspace &workspace_;
    Buffer base_, gradient_x_, gradient_y_, u_, spare_; ///< of all channels
    Buffer right_side_;                                 ///< of a group
    Buffer valid_primal_, valid_dx_, valid_dy_;
    Buffer primal_variance_, dx_variance_, dy_variance_;
    std::uint32_t variance_plane_ = 0;   ///< from a channel's variances to the next
    Buffer base_x_, base_y_, base_data_; ///< those of valid_dx_ and so on where these say it all
    Buffer zero_, held_;
    bool anything_missing_ = false, held_is_known_ = false;
    std::uint64_t not_held_ = 0;
    double gradient_variance_scale_ = 0, primal_variance_scale_ = 0;
};

} // namespace gradus::solver
