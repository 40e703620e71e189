#include "solver/sums.h"

#include "kernels/shared/solver_shared.h"

#include <utility>

namespace gradus::solver {

namespace {

/// So few parts are added by one work-item.
constexpr std::uint32_t few = 1024;

} // namespace

Sums::Sums(const PlaneMaker &make, const Grid &grid, std::uint32_t channels)
    : make_(make), grid_(grid), channels_(channels),
      reduced_{make.reals("reduced", std::size_t(quotient_up(grid_.plane, SOLVER_REDUCTION)) * channels * 2),
               make.reals("reduced",
                          std::size_t(quotient_up(grid_.plane, SOLVER_REDUCTION * SOLVER_REDUCTION)) * channels * 2)},
      scalars_(make.reals("scalars", std::size_t(channels) * SOLVER_SCALAR_SLOTS)) {}

void Sums::bind(Kernel &kernel, std::uint32_t planes, std::uint32_t partials) {
    partials_ = partials;
    const std::size_t count = std::size_t(partials_) * planes;
    if (!partial_.valid() || partial_.bytes() < count * real_bytes(make_.precision()))
        partial_ = make_.reals("partial", count);
    kernel.bind(partial_);
    kernel.set("partials", partials_);
}

void Sums::sum(Kernels &kernels, std::uint32_t slot, Planes planes) {
    run(kernels, &partial_, partials_, 1, slot, slot, planes);
}

void Sums::sum_two(Kernels &kernels, std::uint32_t slot, std::uint32_t second, Planes planes) {
    run(kernels, &partial_, partials_, 2, slot, second, planes);
}

void Sums::product(Kernels &kernels, Planes planes, const Buffer &a, const Buffer &b, std::uint32_t slot) {
    kernels.reduce_product.bind("a", a);
    kernels.reduce_product.bind("b", b);
    kernels.reduce_product.bind("c", b);
    run_products(kernels, kernels.reduce_product, planes, 1, slot, slot);
}

void Sums::products(Kernels &kernels, Planes planes, const Buffer &a, const Buffer &b, const Buffer &c,
                    std::uint32_t slot, std::uint32_t second) {
    kernels.reduce_two_products.bind("a", a);
    kernels.reduce_two_products.bind("b", b);
    kernels.reduce_two_products.bind("c", c);
    run_products(kernels, kernels.reduce_two_products, planes, 2, slot, second);
}

void Sums::sum_of(Kernels &kernels, const Buffer &a, std::uint32_t slot) {
    kernels.reduce_plane.bind("a", a);
    run_products(kernels, kernels.reduce_plane, {0, channels_}, 1, slot, slot);
}

void Sums::run_products(Kernels &kernels, Kernel &kernel, Planes planes, std::uint32_t sums, std::uint32_t slot,
                        std::uint32_t second) {
    const std::uint32_t reduced = quotient_up(grid_.plane, SOLVER_REDUCTION),
                        groups = quotient_up(reduced, SOLVER_TILE);
    kernel.set("plane", grid_.plane);
    kernel.set("reduced_count", reduced);
    kernel.bind("reduced", reduced_[0]);
    kernel.set("channel_count", planes.count);
    launch_groups(kernel, groups, planes.count);
    run(kernels, &reduced_[0], reduced, sums, slot, second, planes);
}

void Sums::run(Kernels &kernels, const Buffer *from, std::uint32_t count, std::uint32_t sums, std::uint32_t slot,
               std::uint32_t second, Planes planes) {
    while (count > few) {
        // The second of the two is as large as a step from the first needs.
        const Buffer *to = from == &reduced_[0] ? &reduced_[1] : &reduced_[0];
        const std::uint32_t reduced = quotient_up(count, SOLVER_REDUCTION), groups = quotient_up(reduced, SOLVER_TILE);
        Kernel &reduce = kernels.reduce;
        reduce.bind("partial", *from);
        reduce.bind("reduced", *to);
        reduce.set("count", count);
        reduce.set("reduced_count", reduced);
        launch_groups(reduce, groups, std::size_t(planes.count) * sums);
        from = to;
        count = reduced;
    }
    Kernel &finish = kernels.finish_sum;
    finish.bind("partial", *from);
    finish.bind(scalars_);
    finish.set("count", count);
    finish.set("sums", sums);
    finish.set("first_channel", planes.first);
    finish.set("channel_count", planes.count);
    finish.set("slot", slot);
    finish.set("second_slot", second);
    launch_groups(finish, 1);
}

std::vector<double> Sums::read(std::uint32_t slot) const {
    const auto mapping = scalars_.map(Access::read);
    std::vector<double> values;
    for (std::uint32_t c = 0; c < channels_; ++c) {
        const std::size_t at = std::size_t(c) * SOLVER_SCALAR_SLOTS + slot;
        values.push_back(make_.precision() == Precision::double_ ? mapping.as<double>()[at] : mapping.as<float>()[at]);
    }
    return values;
}

double Sums::read(std::uint32_t slot, std::uint32_t channel) const { return read(slot)[channel]; }

double Sums::read_total(std::uint32_t slot) const {
    double total = 0;
    for (const double value : read(slot))
        total += value;
    return total;
}

} // namespace gradus::solver
