// Gradient-domain path tracing against path tracing of other seeds, on scenes that have no reference of another
// renderer: whether primal and differences have the means that they should.
#pragma once

#include "runtime/scene/scene.h"
#include "tests/support/small_scenes.h"

#include <cstdint>
#include <string>
#include <vector>

namespace gradus::testing {

/// What independent residuals, estimates less truths, say of a bias.
struct BiasEstimate {
    double squared = 0;        ///< squared bias, summed over values; without bias itself, so it may be negative
    double standard_error = 0; ///< of it, where there is no bias
    double magnitude = 0;      ///< sum of squares of the truth, without bias too

    /// Within four standard errors of none. One test in 30 000 would fail by chance if pairs of residuals had normal
    /// sums; a relative bias of 1e-5 is what rounding may do.
    bool is_none() const { return squared <= 4 * standard_error + 1e-10 * magnitude; }
    /// The relative bias that cannot be excluded: a biased method shows, and noise that would hide one does, too.
    double at_most() const;
};

/// From vectors of equal size: estimates and truths, an entry for each seed.
BiasEstimate estimate_bias(const std::vector<std::vector<double>> &estimates,
                           const std::vector<std::vector<double>> &truths);

struct GradientBias {
    BiasEstimate primal, differences; ///< of all channels; differences to the right and downwards
    double at_most() const;
};

struct GradientSamples {
    std::size_t seeds = 8;
    std::uint64_t gradient_domain = 16, path_tracing = 32; ///< samples a pixel and seed
    bool by_tree = false; ///< the gradient-domain one chooses lights from a tree, the other one by power
};

/// The beginning of a small scene, of 32 x 32 pixels; gradient_bias() sets its samples.
SceneMaker scene_for_bias(int max_depth = 6);

/// Renders a scene with both methods. What the camera sees of lights counts as primal.
GradientBias gradient_bias(const Scene &scene, const GradientSamples &samples);
/// Another scene, of the same size, for the path tracer: one that must look the same.
GradientBias gradient_bias(const Scene &scene, const Scene &path_traced, const GradientSamples &samples);

/// The texts of a row of docs/stability.md.
struct GradientRow {
    const char *area;
    std::string failure, provoked_by, contract;
    double limit; ///< of the bias
};

/// Expects that there is no bias, and records what cannot be excluded.
void expect_no_bias(const GradientBias &bias, const GradientRow &row);

} // namespace gradus::testing
