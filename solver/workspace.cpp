#include "solver/workspace.h"

#include <algorithm>

namespace gradus::solver {

namespace {

/// Planes that a solve by the L1 norm holds: by channel I0, both gradients, u and one to spare; weights, partial sums
/// and what is valid once for all; and by channel of a group those of the linear solver.
constexpr std::uint64_t planes_by_channel = 5, planes_once = 11, planes_by_channel_of_group = 8;

/// Of small images, on a CPU, launches are what counts, and channels together take fewer. The planes of the linear
/// solver for all channels are to stay in a cache. Over one channel after the other, L1 and weighted, two cores: 0.7 to
/// 0.8 of the time at 256x256, which is in here, 0.9 to 1.1 at 512x512, which is not. The more cores, the less of a
/// launch has each, and the longer it takes to wake them (15 us on two, 150 us on sixteen): so by their square.
constexpr std::uint64_t bytes_of_two_cores = 8u << 20;

std::uint64_t bytes_together(const DeviceDescription &device) {
    const double pairs = std::clamp(device.compute_units / 2.0, 1.0, 1024.0);
    return static_cast<std::uint64_t>(pairs * pairs * bytes_of_two_cores);
}

} // namespace

std::uint32_t channels_together(const DeviceDescription &device, const Grid &grid, std::uint32_t channels,
                                Precision precision) {
    const std::uint64_t of_linear_solver = planes_by_channel_of_group * channels * grid.plane * real_bytes(precision);
    if (device.is_host && of_linear_solver > bytes_together(device))
        return 1;
    const std::uint64_t planes = (planes_by_channel + planes_by_channel_of_group) * channels + planes_once;
    return planes * grid.plane * real_bytes(precision) <= device.memory_bytes / 2 ? channels : 1;
}

Workspace::Workspace(Device &device, std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                     Precision precision, std::uint32_t together)
    : channels(channels),
      together(together > 0 ? std::min(together, channels)
                            : channels_together(device.description(), Grid(width, height), channels, precision)),
      make(device, precision), multigrid(make, width, height, this->together),
      sums(make, multigrid.system().grid, channels), linear(make, multigrid, sums, this->together) {}

std::vector<Planes> Workspace::groups() const {
    std::vector<Planes> groups;
    for (std::uint32_t first = 0; first < channels; first += together)
        groups.push_back({first, std::min(together, channels - first)});
    return groups;
}

Kernels &Workspace::kernels(Weights weights) {
    std::unique_ptr<Kernels> &kernels = kernels_[weights];
    if (!kernels)
        kernels = std::make_unique<Kernels>(make.device(), make.precision(), channels, weights);
    return *kernels;
}

} // namespace gradus::solver
