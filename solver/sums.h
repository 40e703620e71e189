// Sums over images, on the device, in a fixed order.
#pragma once

#include "solver/grid.h"
#include "solver/kernels.h"

#include <vector>

namespace gradus::solver {

/// Places of scalars, each with a value for every channel.
enum Slot : std::uint32_t {
    slot_direction_product, ///< <direction, A direction>
    slot_residual_product,  ///< <z, residual>
    slot_image_product,     ///< <z, A direction>
    slot_sum,               ///< anything
    slot_second_sum,
    slot_mean,
};

class Sums {
  public:
    /// For kernels that leave up to two sums over `grid` for each of `channels` planes.
    Sums(const PlaneMaker &make, const Grid &grid, std::uint32_t channels);

    /// Binds `scalars`.
    void bind_scalars(Kernel &kernel) const { kernel.bind(scalars_); }
    /// Binds `partial`, with room for `planes` planes of parts, and `partials`, how many a plane has: one for each
    /// pixel of the grid, or for each eight of a line.
    void bind_parts(Kernel &kernel, std::uint32_t planes) { bind(kernel, planes, grid_.partials()); }
    void bind_parts_of_eights(Kernel &kernel, std::uint32_t planes) {
        bind(kernel, planes, quotient_up(grid_.width, 8) * grid_.height);
    }

    /// Adds the parts that a kernel left, which bind_parts() was called for last. `planes`: those that each sum has, of
    /// channels, or {0, 1}: then the result is that of channel 0.
    void sum(Kernels &kernels, std::uint32_t slot, Planes planes);
    void sum_two(Kernels &kernels, std::uint32_t slot, std::uint32_t second, Planes planes);
    /// <a, b> of planes whose borders are zero, which hold these channels alone; and <a, c>.
    void product(Kernels &kernels, Planes planes, const Buffer &a, const Buffer &b, std::uint32_t slot);
    void products(Kernels &kernels, Planes planes, const Buffer &a, const Buffer &b, const Buffer &c,
                  std::uint32_t slot, std::uint32_t second);
    /// The sum of each channel of a.
    void sum_of(Kernels &kernels, const Buffer &a, std::uint32_t slot);

    /// The scalar of each channel. Waits for the device.
    std::vector<double> read(std::uint32_t slot) const;
    double read(std::uint32_t slot, std::uint32_t channel) const;
    double read_total(std::uint32_t slot) const;

  private:
    void bind(Kernel &kernel, std::uint32_t planes, std::uint32_t partials);
    /// Goes on from `count` parts for each sum and plane.
    void run(Kernels &kernels, const Buffer *from, std::uint32_t count, std::uint32_t sums, std::uint32_t slot,
             std::uint32_t second, Planes planes);
    void run_products(Kernels &kernels, Kernel &kernel, Planes planes, std::uint32_t sums, std::uint32_t slot,
                      std::uint32_t second);

    const PlaneMaker make_;
    const Grid grid_;
    std::uint32_t channels_;
    std::uint32_t partials_ = 0; ///< of a plane in partial_
    Buffer partial_, reduced_[2], scalars_;
};

} // namespace gradus::solver
