// The solver's kernels, compiled for one kind of weights.
#pragma once

#include "runtime/device/program.h"

#include <cstdint>

namespace gradus::solver {

/// How the weights of a system lie in memory.
enum class Weights {
    uniform,     ///< products of columns and rows, nothing stored by pixel
    joint,       ///< one plane for all channels
    per_channel, ///< a plane for each channel
};

struct Kernels {
    Kernels(Device &device, Precision precision, std::uint32_t channels, Weights weights,
            const KernelLibrary::Progress &progress = {});

    const Weights weights;
    const std::uint32_t channels;
    const std::uint32_t weight_planes;

    Kernel residual, smooth, copy, invert_diagonal, store_weights;
    Kernel descend, ascend, prolong, coarsen_weights, coarse_cycle;
    Kernel direction, advance;
    Kernel reduce, reduce_product, reduce_two_products, reduce_plane, finish_sum;
    Kernel import_image, import_variance, gradient_residual, right_side, start, start_between_neighbours, compose;
    Kernel base_weights, least_squares_weights, residual_scale, reweight, extrapolate, squared_norm;
    Kernel mark_held, add_base;
    Kernel largest_of_columns, third_largest, correction_weights, correction_right_side, correction_pass,
        add_correction;

    /// Every kernel that was built.
    std::vector<Kernel *> all();
};

} // namespace gradus::solver
