#include "solver/kernels.h"

#include "solver/tiles.h"

#include <fmt/format.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gradus::solver {

namespace {

/// The weights for which a kernel is there, if not for all.
enum class Only { neither, uniform, weighted };

struct Entry {
    Kernel Kernels::*kernel;
    const char *file, *name;
    Only only = Only::neither;
    const char *entry = nullptr; ///< in the file, where it is not the name
};

constexpr Entry entries[] = {
    {&Kernels::residual, "stencil", "residual"},
    {&Kernels::smooth, "stencil", "smooth"},
    {&Kernels::copy, "stencil", "copy"},
    {&Kernels::invert_diagonal, "stencil", "invert_diagonal"},
    {&Kernels::store_weights, "stencil", "store_weights", Only::uniform},
    {&Kernels::descend, "cycle", "descend"},
    {&Kernels::ascend, "cycle", "ascend"},
    {&Kernels::prolong, "transfer", "prolong"},
    {&Kernels::coarsen_weights, "transfer", "coarsen_weights", Only::weighted},
    {&Kernels::coarse_cycle, "coarse_cycle", "coarse_cycle"},
    {&Kernels::direction, "conjugate_gradient", "direction"},
    {&Kernels::advance, "conjugate_gradient", "advance"},
    {&Kernels::reduce, "sum", "reduce"},
    {&Kernels::reduce_product, "sum", "reduce_products"},
    {&Kernels::reduce_two_products, "sum", "reduce_products", Only::neither, "reduce_two_products"},
    {&Kernels::reduce_plane, "sum", "reduce_plane"},
    {&Kernels::finish_sum, "sum", "finish_sum"},
    {&Kernels::start, "input", "start"},
    {&Kernels::start_between_neighbours, "input", "start_between_neighbours", Only::weighted},
    {&Kernels::import_image, "input", "import_image"},
    {&Kernels::import_variance, "input", "import_variance"},
    {&Kernels::gradient_residual, "input", "gradient_residual"},
    {&Kernels::right_side, "input", "right_side"},
    {&Kernels::compose, "output", "compose"},
    {&Kernels::base_weights, "weights", "base_weights", Only::weighted},
    {&Kernels::least_squares_weights, "weights", "least_squares_weights", Only::weighted},
    {&Kernels::residual_scale, "weights", "residual_scale", Only::weighted},
    {&Kernels::reweight, "weights", "reweight", Only::weighted},
    {&Kernels::extrapolate, "weights", "extrapolate", Only::weighted},
    {&Kernels::squared_norm, "weights", "squared_norm"},
    {&Kernels::mark_held, "weights", "mark_held", Only::weighted},
    {&Kernels::add_base, "output", "add_base"},
    {&Kernels::largest_of_columns, "mean_correction", "largest_of_columns", Only::weighted},
    {&Kernels::third_largest, "mean_correction", "third_largest", Only::weighted},
    {&Kernels::correction_weights, "mean_correction", "correction_weights", Only::weighted},
    {&Kernels::correction_right_side, "mean_correction", "correction_right_side", Only::weighted},
    {&Kernels::correction_pass, "mean_correction", "correction_pass", Only::weighted},
    {&Kernels::add_correction, "mean_correction", "add_correction", Only::weighted},
};

} // namespace

Kernels::Kernels(Device &device, Precision precision, std::uint32_t channels, Weights weights,
                 const KernelLibrary::Progress &progress)
    : weights(weights), channels(channels), weight_planes(weights == Weights::per_channel ? channels : 1) {
    KernelLibrary library(device,
                          {{"SOLVER_CHANNELS", static_cast<int>(channels)},
                           {"SOLVER_WEIGHTED", weights != Weights::uniform},
                           {"SOLVER_JOINT", weights != Weights::per_channel}},
                          precision);
    std::vector<const Entry *> wanted;
    std::vector<KernelRequest> requests;
    const std::map<std::string, std::string> tiles = {
        {"LOCAL_REALS", std::to_string(Tiles(device.description(), precision).local_reals())}};
    for (const Entry &entry : entries) {
        if (entry.only == (weights == Weights::uniform ? Only::weighted : Only::uniform))
            continue;
        wanted.push_back(&entry);
        requests.push_back({entry.name, fmt::format("kernels/solver/{}.cl", entry.file),
                            entry.entry ? entry.entry : entry.name,
                            std::string_view(entry.file) == "cycle" ? tiles : std::map<std::string, std::string>()});
    }
    std::vector<Kernel> built = library.build(requests, progress);
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
