#include "solver/kernels.h"

#include <fmt/format.h>

#include <vector>

namespace gradus::solver {

namespace {

struct Entry {
    Kernel Kernels::*kernel;
    const char *file, *name;
    bool weighted_only;
    const char *entry = nullptr; ///< in the file, where it is not the name
};

constexpr Entry entries[] = {
    {&Kernels::residual, "stencil", "residual", false},
    {&Kernels::smooth, "stencil", "smooth", false},
    {&Kernels::smooth_twice_from_zero, "stencil", "smooth_twice_from_zero", false},
    {&Kernels::copy, "stencil", "copy", false},
    {&Kernels::invert_diagonal, "stencil", "invert_diagonal", false},
    {&Kernels::restrict_sum, "transfer", "restrict_sum", false},
    {&Kernels::prolong, "transfer", "prolong", false},
    {&Kernels::prolong_onto, "transfer", "prolong_onto", false},
    {&Kernels::coarsen_weights, "transfer", "coarsen_weights", true},
    {&Kernels::direction, "conjugate_gradient", "direction", false},
    {&Kernels::advance, "conjugate_gradient", "advance", false},
    {&Kernels::reduce, "sum", "reduce", false},
    {&Kernels::reduce_product, "sum", "reduce_products", false},
    {&Kernels::reduce_two_products, "sum", "reduce_products", false, "reduce_two_products"},
    {&Kernels::reduce_plane, "sum", "reduce_plane", false},
    {&Kernels::finish_sum, "sum", "finish_sum", false},
    {&Kernels::start, "input", "start", false},
    {&Kernels::start_between_neighbours, "input", "start_between_neighbours", true},
    {&Kernels::import_plane, "input", "import_plane", false},
    {&Kernels::gradient_residual, "input", "gradient_residual", false},
    {&Kernels::right_side, "input", "right_side", false},
    {&Kernels::compose, "output", "compose", false},
    {&Kernels::base_weights, "weights", "base_weights", true},
    {&Kernels::least_squares_weights, "weights", "least_squares_weights", true},
    {&Kernels::residual_scale, "weights", "residual_scale", true},
    {&Kernels::reweight, "weights", "reweight", true},
    {&Kernels::extrapolate, "weights", "extrapolate", true},
    {&Kernels::squared_norm, "weights", "squared_norm", false},
    {&Kernels::fill_ring, "fill", "fill_ring", false},
    {&Kernels::mark_held, "fill", "mark_held", true},
    {&Kernels::add_base, "fill", "add_base", false},
    {&Kernels::largest_of_columns, "mean_correction", "largest_of_columns", true},
    {&Kernels::third_largest, "mean_correction", "third_largest", true},
    {&Kernels::correction_weights, "mean_correction", "correction_weights", true},
    {&Kernels::correction_right_side, "mean_correction", "correction_right_side", true},
    {&Kernels::correction_pass, "mean_correction", "correction_pass", true},
    {&Kernels::add_correction, "mean_correction", "add_correction", true},
};

} // namespace

Kernels::Kernels(Device &device, Precision precision, std::uint32_t channels, Weights weights)
    : weights(weights), channels(channels), weight_planes(weights == Weights::per_channel ? channels : 1) {
    KernelLibrary library(device,
                          {{"SOLVER_CHANNELS", static_cast<int>(channels)},
                           {"SOLVER_WEIGHTED", weights != Weights::uniform},
                           {"SOLVER_JOINT", weights != Weights::per_channel}},
                          precision);
    std::vector<const Entry *> wanted;
    std::vector<KernelRequest> requests;
    for (const Entry &entry : entries) {
        if (entry.weighted_only && weights == Weights::uniform)
            continue;
        wanted.push_back(&entry);
        requests.push_back(
            {entry.name, fmt::format("kernels/solver/{}.cl", entry.file), entry.entry ? entry.entry : entry.name, {}});
    }
    std::vector<Kernel> built = library.build(requests);
    for (std::size_t i = 0; i < wanted.size(); ++i)
        this->*wanted[i]->kernel = std::move(built[i]);
}

std::vector<Kernel *> Kernels::all() {
    std::vector<Kernel *> kernels;
    for (const Entry &entry : entries)
        if ((this->*entry.kernel).valid())
            kernels.push_back(&(this->*entry.kernel));
    return kernels;
}

} // namespace gradus::solver
