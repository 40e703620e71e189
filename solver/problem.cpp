#include "solver/problem.h"

#include <algorithm>
#include <cmath>

namespace gradus::solver {

Problem::Problem(Workspace &workspace) : workspace_(workspace) {}

void Problem::allocate() {
    if (base_.valid())
        return;
    const PlaneMaker &make = workspace_.make;
    const Grid &grid = workspace_.grid();
    base_ = make.planes("base", grid, workspace_.channels);
    gradient_x_ = make.planes("gradient_x", grid, workspace_.channels);
    gradient_y_ = make.planes("gradient_y", grid, workspace_.channels);
    u_ = make.planes("u", grid, workspace_.channels);
    valid_primal_ = make.planes("valid_primal", grid, 1);
    valid_dx_ = make.planes("valid_dx", grid, 1);
    valid_dy_ = make.planes("valid_dy", grid, 1);
}

void Problem::import_plane(Kernel &kernel, std::uint32_t plane, const Buffer &packed, const Buffer &imported,
                           std::uint32_t columns, std::uint32_t rows) {
    kernel.set("edge_columns", columns);
    kernel.set("edge_rows", rows);
    kernel.bind("packed", packed);
    kernel.bind("imported", imported);
    workspace_.grid().launch(kernel, {plane, 1});
}

double Problem::import_image(const Buffer &packed, const Buffer &imported, const Buffer &valid, std::uint32_t columns,
                             std::uint32_t rows) {
    Kernel &kernel = workspace_.any_kernels().import_image;
    kernel.bind("valid", valid);
    workspace_.sums.bind_parts(kernel, 1);
    import_plane(kernel, 0, packed, imported, columns, rows);
    workspace_.sums.sum(workspace_.any_kernels(), slot_sum, {0, 1});
    return workspace_.sums.read(slot_sum, 0);
}

double Problem::mean_variance(const Buffer &packed, std::uint32_t planes, const Buffer &variance, std::uint32_t columns,
                              std::uint32_t rows, bool of_roots) {
    Kernel &kernel = workspace_.any_kernels().import_variance;
    kernel.set("of_roots", of_roots);
    double sum = 0, count = double(columns) * rows * planes;
    for (std::uint32_t plane = 0; plane < planes; ++plane) { // parts of all would take memory
        workspace_.sums.bind_parts(kernel, 2);
        import_plane(kernel, plane, packed, variance, columns, rows);
        workspace_.sums.sum_two(workspace_.any_kernels(), slot_sum, slot_second_sum, {0, 1});
        sum += workspace_.sums.read(slot_sum, 0);
        count -= workspace_.sums.read(slot_second_sum, 0);
    }
    return sum / std::max(count, 1.0);
}

void Problem::import(const Inputs &images, PoissonReport &report) {
    allocate();
    const Grid &grid = workspace_.grid();
    const std::uint32_t w = grid.width, h = grid.height;
    const double missing = import_image(images.primal(), base_, valid_primal_, w, h);
    const double missing_x = import_image(images.dx(), gradient_x_, valid_dx_, w - 1, h);
    const double missing_y = import_image(images.dy(), gradient_y_, valid_dy_, w, h - 1);
    report.missing_primal = static_cast<std::uint64_t>(missing);
    report.missing_dx = static_cast<std::uint64_t>(missing_x);
    report.missing_dy = static_cast<std::uint64_t>(missing_y);
    held_is_known_ = false;
    anything_missing_ = missing + missing_x + missing_y > 0;
    if (missing > 0)
        fill_missing(workspace_.make.precision(), grid, workspace_.channels, valid_primal_, base_);
    Kernel &kernel = workspace_.any_kernels().gradient_residual;
    kernel.bind("base", base_);
    kernel.bind("dx", gradient_x_);
    kernel.bind("dy", gradient_y_);
    kernel.bind(valid_dx_);
    kernel.bind(valid_dy_);
    kernel.bind(gradient_x_);
    kernel.bind(gradient_y_);
    grid.launch(kernel, {0, workspace_.channels});
}

void Problem::import_variances(const Inputs &images, const PoissonOptions &options) {
    const bool for_weights = options.weigh_by_variance, of_roots = for_weights || options.norm == PoissonNorm::l1;
    const std::uint32_t w = workspace_.grid().width, h = workspace_.grid().height;
    const std::uint32_t planes = images.one_variance ? 1 : workspace_.channels;
    variance_plane_ = images.one_variance ? 0 : workspace_.grid().plane;
    const std::size_t bytes = std::size_t(workspace_.grid().plane) * planes * real_bytes(workspace_.make.precision());
    for (Buffer *variance : {&primal_variance_, &dx_variance_, &dy_variance_})
        if (!for_weights)
            *variance = u_; // which nothing is in yet
        else if (!variance->valid() || variance->bytes() < bytes)
            *variance = workspace_.make.planes("variance", workspace_.grid(), planes);
    const double x = mean_variance(images.dx_variance(), planes, dx_variance_, w - 1, h, of_roots);
    const double y = mean_variance(images.dy_variance(), planes, dy_variance_, w, h - 1, of_roots);
    const double horizontal = double(w - 1) * h, vertical = double(w) * (h - 1);
    const double primal = mean_variance(images.primal_variance(), planes, primal_variance_, w, h, of_roots);
    const auto scale_of = [&](double mean) { return of_roots ? std::pow(mean, 4) : mean; };
    primal_variance_scale_ = scale_of(primal);
    gradient_variance_scale_ = scale_of((x * horizontal + y * vertical) / std::max(horizontal + vertical, 1.0));
    if (!for_weights)
        primal_variance_ = dx_variance_ = dy_variance_ = Buffer();
}

double Problem::alpha_from_variances(double otherwise) const {
    if (primal_variance_scale_ > 0)
        return std::sqrt(std::max(gradient_variance_scale_, 0.0) / primal_variance_scale_);
    return gradient_variance_scale_ > 0 ? 1 : otherwise;
}

void Problem::make_base_weights(Kernels &kernels, bool by_variance, double largest_weight) {
    const Grid &grid = workspace_.grid();
    const std::uint32_t planes = kernels.weight_planes;
    workspace_.multigrid.allocate_weights(planes);
    if (planes == 1 && !by_variance) {
        base_x_ = valid_dx_;
        base_y_ = valid_dy_;
        base_data_ = valid_primal_;
        return;
    }
    const auto make = [&](Buffer &weights, const char *name, const Buffer &valid) {
        const std::size_t bytes = std::size_t(grid.plane) * planes * real_bytes(workspace_.make.precision());
        if (!weights.valid() || weights.argument() == valid.argument() || weights.bytes() < bytes)
            weights = workspace_.make.planes(name, grid, planes);
    };
    make(base_x_, "base_x", valid_dx_);
    make(base_y_, "base_y", valid_dy_);
    make(base_data_, "base_data", valid_primal_);
    Kernel &kernel = kernels.base_weights;
    kernel.set("weight_plane", workspace_.system().weight_plane);
    kernel.set("variance_plane", variance_plane_);
    kernel.set("by_variances", by_variance);
    kernel.set_real("largest_weight", largest_weight);
    kernel.set_real("gradient_variance_scale", gradient_variance_scale_);
    kernel.set_real("primal_variance_scale", primal_variance_scale_);
    kernel.bind(valid_primal_);
    kernel.bind(valid_dx_);
    kernel.bind(valid_dy_);
    kernel.bind("primal_variance", by_variance ? primal_variance_ : u_);
    kernel.bind("dx_variance", by_variance ? dx_variance_ : u_);
    kernel.bind("dy_variance", by_variance ? dy_variance_ : u_);
    bind(kernel);
    grid.launch(kernel, {0, planes});
}

void Problem::bind(Kernel &kernel) const {
    kernel.bind(gradient_x_);
    kernel.bind(gradient_y_);
    if (base_x_.valid()) {
        kernel.bind("base_x", base_x_);
        kernel.bind("base_y", base_y_);
        kernel.bind("base_data", base_data_);
    }
}

void Problem::use_least_squares_weights(Kernels &kernels, double alpha) {
    if (kernels.weights == Weights::uniform) {
        workspace_.multigrid.set_uniform(kernels, alpha * alpha);
        return;
    }
    Kernel &kernel = kernels.least_squares_weights;
    workspace_.system().bind(kernel);
    bind(kernel);
    kernel.set_real("alpha", alpha);
    workspace_.grid().launch(kernel, {0, kernels.weight_planes});
    workspace_.multigrid.coarsen_weights(kernels);
}

Buffer &Problem::spare() {
    if (!spare_.valid())
        spare_ = workspace_.make.planes("spare", workspace_.grid(), workspace_.channels);
    return spare_;
}

const Buffer &Problem::right_side() {
    if (!right_side_.valid())
        right_side_ = workspace_.make.planes("right_side", workspace_.grid(), workspace_.together);
    return right_side_;
}

const Buffer &Problem::make_right_side(Kernels &kernels, Planes group) {
    Kernel &kernel = kernels.right_side;
    workspace_.system().bind(kernel);
    bind(kernel);
    kernel.bind(right_side());
    workspace_.grid().launch(kernel, group);
    return right_side();
}

void Problem::start(const Inputs &images) {
    Kernel &kernel = workspace_.any_kernels().start;
    kernel.set("has_start", bool(images.start));
    kernel.bind("base", base_);
    kernel.bind("packed", images.start ? images.start() : base_);
    kernel.bind("u", u_);
    workspace_.grid().launch(kernel, {0, workspace_.channels});
}

void Problem::start_between_neighbours(Kernels &kernels) {
    Kernel &kernel = kernels.start_between_neighbours;
    bind(kernel);
    kernel.bind("base", base_);
    kernel.bind("u", u_);
    workspace_.grid().launch(kernel, {0, workspace_.channels});
}

void Problem::remove_mean(Kernels &kernels) {
    const Grid &grid = workspace_.grid();
    workspace_.sums.sum_of(kernels, u_, slot_mean);
    add_to_u(kernels, zero(), 1 / (double(grid.width) * grid.height));
}

void Problem::add_to_u(Kernels &kernels, const Buffer &image, double mean_factor) {
    Kernel &add = kernels.add_base;
    workspace_.sums.bind_scalars(add);
    add.set("mean_slot", slot_mean);
    add.set_real("mean_factor", mean_factor);
    add.bind("base", image);
    add.bind("u", u_);
    workspace_.grid().launch(add, {0, workspace_.channels});
}

const Buffer &Problem::zero() {
    if (!zero_.valid())
        zero_ = workspace_.make.planes("base", workspace_.grid(), workspace_.channels);
    return zero_;
}

double Problem::squared_norm(Kernels &kernels) {
    Kernel &kernel = kernels.squared_norm;
    workspace_.system().bind(kernel);
    workspace_.sums.bind_parts(kernel, workspace_.channels);
    bind(kernel);
    kernel.bind("u", u_);
    workspace_.grid().launch(kernel, {0, workspace_.channels});
    workspace_.sums.sum(kernels, slot_sum, {0, workspace_.channels});
    return workspace_.sums.read_total(slot_sum);
}

void Problem::find_held(Kernels &kernels) {
    held_is_known_ = true;
    not_held_ = 0;
    if (!anything_missing_)
        return;
    const Grid &grid = workspace_.grid();
    if (!held_.valid())
        held_ = workspace_.make.planes("valid", grid, 1);
    Kernel &kernel = kernels.mark_held;
    workspace_.system().bind(kernel);
    bind(kernel);
    workspace_.sums.bind_parts(kernel, 1);
    kernel.bind("valid", held_);
    grid.launch(kernel, {0, 1});
    workspace_.sums.sum(kernels, slot_sum, {0, 1});
    not_held_ = static_cast<std::uint64_t>(workspace_.sums.read(slot_sum, 0));
}

double Problem::norm_of_right_side(Kernels &kernels) {
    for (const Planes group : workspace_.groups()) {
        const Buffer &right_side = make_right_side(kernels, group);
        workspace_.sums.product(workspace_.any_kernels(), group, right_side, right_side, slot_sum);
    }
    const double right_side = workspace_.sums.read_total(slot_sum);
    workspace_.sums.product(workspace_.any_kernels(), {0, workspace_.channels}, base_, base_, slot_sum);
    return std::sqrt(std::max(right_side, 1e-12 * workspace_.sums.read_total(slot_sum)));
}

std::uint64_t Problem::compose(Kernels &kernels, const Inputs &images, bool keep_mean, Buffer &result) {
    const Grid &grid = workspace_.grid();
    if (keep_mean)
        workspace_.sums.sum_of(kernels, u_, slot_mean);
    const double mean_factor = keep_mean ? 1 / (double(grid.width) * grid.height) : 0;
    if (!held_is_known_)
        find_held(kernels);
    if (not_held_ > 0) {
        add_to_u(kernels, base_, mean_factor);
        fill_missing(workspace_.make.precision(), grid, workspace_.channels, held_, u_);
    }
    Kernel &compose = kernels.compose;
    workspace_.sums.bind_scalars(compose);
    compose.set("mean_slot", slot_mean);
    compose.set_real("mean_factor", not_held_ > 0 ? 0 : mean_factor);
    compose.set("has_direct", bool(images.direct));
    compose.bind("base", not_held_ > 0 ? zero() : base_);
    compose.bind("u", u_);
    compose.bind("direct", images.direct ? images.direct() : result);
    compose.bind("packed", result);
    grid.launch(compose, {0, workspace_.channels});
    return not_held_;
}

} // namespace gradus::solver
