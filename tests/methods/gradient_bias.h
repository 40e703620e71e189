// Gradient-domain path tracing against path tracing of other seeds, on scenes that have no reference of another
// renderer: whether primal and differences have the means that they should.
#pragma once

#include "runtime/scene/scene.h"
#include "tests/support/render.h"
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
    /// The root of the estimate, relatively: what a planted defect makes.
    double found() const;
};

/// How far off offset paths are, by what two defects would make of the truth. Where they carry 1 + e of their value to
/// the right and downwards and 1 - e back, as with a wrong Jacobian, differences are off by e / 2 of the sum of both
/// pixels; where 1 + e both ways, by e / 2 of themselves. (Less where shifts fail. What the camera sees of lights is
/// left out, since no offset path carries it.) Both are sums over all values that are linear in the residuals, so that
/// noise averages out, as it does not in squares.
struct OffsetError {
    Spread one_way, both_ways; ///< e, over seeds

    /// Eight means have a Student's t distribution of 7 degrees of freedom: by chance one in 30 000 is 9.4 standard
    /// errors off, and fewer of more seeds; rounding may do 1e-5.
    bool is_none() const;
    /// What four standard errors cannot exclude, one way: differences are small beside values, so that what is off both
    /// ways is known far less.
    double at_most() const;
};

/// From vectors of equal size: estimates and truths, an entry for each seed.
BiasEstimate estimate_bias(const std::vector<std::vector<double>> &estimates,
                           const std::vector<std::vector<double>> &truths);

struct GradientBias {
    BiasEstimate primal, differences; ///< of all channels; differences to the right and downwards
    OffsetError offsets;
    double at_most() const;
    double found() const;
};

struct GradientSamples {
    std::size_t seeds = 8;
    std::uint64_t gradient_domain = 16, path_tracing = 32; ///< samples a pixel and seed
    bool by_tree = false; ///< the gradient-domain one chooses lights from a tree, the other one by power
};

/// The beginning of a small scene, of 32 x 32 pixels; gradient_bias() sets its samples.
SceneMaker scene_for_bias(int max_depth = 6);

/// Adds small balls, from (0, 0, z) on to the right, of the kinds that scenes of copies and reconnections have, each of
/// some: with all of them they need the same kernels, which are compiled once.
void hide_all_kinds(SceneMaker &scene, float z = -20);

/// Renders a scene with both methods. What the camera sees of lights counts as primal.
GradientBias gradient_bias(const Scene &scene, const GradientSamples &samples);
/// Another scene, of the same size, for the path tracer: one that must look the same.
GradientBias gradient_bias(const Scene &scene, const Scene &path_traced, const GradientSamples &samples);

/// The texts of a row of docs/stability.md.
struct GradientRow {
    const char *area;
    std::string failure, provoked_by, contract;
    double limit;                ///< of the bias
    double offset_limit = 0.025; ///< of OffsetError
};

/// Expects that there is no bias, and records what cannot be excluded, and what is found: tests/stability/power.py
/// plants defects and takes that.
void expect_no_bias(const GradientBias &bias, const GradientRow &row);

} // namespace gradus::testing
