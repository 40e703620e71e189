#include "solver/multigrid.h"

#include "kernels/shared/solver_shared.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gradus::solver {

namespace {

/// With uniform weights, a grid whose data term outweighs its edges so far is solved by smoothing alone.
constexpr double dominant_data_weight = 64;

/// Grids of so few pixels are done in one launch, by a work-group for each channel: launches of their own take 15 us
/// and more each on two cores, and this one 40 for all grids.
constexpr std::uint64_t most_of_coarsest = 4096;

/// Two steps of smoothing that damp the upper three quarters of the spectrum most: the inverse roots of the Chebyshev
/// polynomial of degree 2 on [1/2, 2].
constexpr double smoothing_steps[] = {1 / (1.25 + 0.75 * std::numbers::sqrt2 / 2),
                                      1 / (1.25 - 0.75 * std::numbers::sqrt2 / 2)};

void set_steps(Kernel &kernel) {
    kernel.set_real("step_0", smoothing_steps[0]);
    kernel.set_real("step_1", smoothing_steps[1]);
}

/// The columns (or rows) of a grid, as kernels/solver/grid.h multiplies them.
struct Line {
    std::vector<double> before, after, size;

    /// `covered`: columns of the finest grid that all of these stand for; `pitch`: that each but the last stands for.
    Line(std::uint32_t count, std::uint32_t covered, double pitch, std::size_t padded)
        : before(padded), after(padded), size(padded) {
        for (std::uint32_t i = 0; i < count; ++i) {
            before[i] = i > 0;
            after[i] = i + 1 < count;
            size[i] = i + 1 < count ? 1 : (covered - (count - 1) * pitch) / pitch;
        }
    }
};

/// A kernel of transfer.cl: an item for 8 coarse columns of each of `rows` rows.
void launch_transfer(Kernel &kernel, const Grid &fine, const Grid &coarse, std::uint32_t rows, Planes planes) {
    fine.bind(kernel);
    kernel.set("coarse_width", coarse.width);
    kernel.set("coarse_height", coarse.height);
    kernel.set("coarse_row", coarse.row);
    kernel.set("coarse_plane", coarse.plane);
    launch_groups(kernel, std::size_t(quotient_up(coarse.width, SOLVER_TILE)) * planes.count, quotient_up(rows, 8));
}

} // namespace

void System::bind(Kernel &kernel) const {
    kernel.set_real("data", data);
    for (const Buffer *buffer : {&column_left, &column_right, &column_size, &row_up, &row_down, &row_size})
        kernel.bind(*buffer);
    kernel.bind(inverse_diagonal);
    if (weight_x.valid()) {
        kernel.bind(weight_x);
        kernel.bind(weight_y);
        kernel.bind(weight_data);
        kernel.set("weight_plane", weight_plane);
    }
}

Multigrid::Multigrid(const PlaneMaker &make, std::uint32_t width, std::uint32_t height, std::uint32_t together)
    : make_(make), together_(together), tiles_(make.device().description(), make.precision()) {
    double pitch = 1;
    for (std::uint32_t w = width, h = height;; w = (w + 1) / 2, h = (h + 1) / 2, pitch *= 2) {
        Level level;
        System &system = level.system;
        system.grid = Grid(w, h);
        const Line columns(w, width, pitch, system.grid.row + SOLVER_MARGIN);
        const Line rows(h, height, pitch, h + SOLVER_MARGIN);
        system.column_left = make.reals("column_left", columns.before);
        system.column_right = make.reals("column_right", columns.after);
        system.column_size = make.reals("column_size", columns.size);
        system.row_up = make.reals("row_up", rows.before);
        system.row_down = make.reals("row_down", rows.after);
        system.row_size = make.reals("row_size", rows.size);
        levels_.push_back(std::move(level));
        if (levels_.size() == 1 || std::uint64_t(w) * h > most_of_coarsest)
            first_coarsest_ = levels_.size();
        else
            coarsest_.plane += levels_.back().system.grid.plane;
        if (w == 1 && h == 1 && levels_.size() > 1)
            break;
    }
}

void Multigrid::allocate() {
    if (levels_.front().right_side.valid())
        return;
    for (std::size_t i = 0; i < first_coarsest_; ++i) {
        Level &level = levels_[i];
        level.right_side = make_.planes("right_side", level.system.grid, together_);
        level.smoothed = make_.planes("smoothed", level.system.grid, together_);
        level.other = make_.planes("smoothed", level.system.grid, together_);
    }
    make_coarsest(coarsest_.right_side, "right_side", together_, [](Level &l) -> Buffer & { return l.right_side; });
    make_coarsest(coarsest_.smoothed, "smoothed", together_, [](Level &l) -> Buffer & { return l.smoothed; });
    make_coarsest(coarsest_.other, "smoothed", together_, [](Level &l) -> Buffer & { return l.other; });
}

void Multigrid::make_coarsest(Buffer &all, const std::string &name, std::uint32_t count,
                              const std::function<Buffer &(Level &)> &part) {
    const std::size_t bytes = count * real_bytes(make_.precision());
    all = make_.reals(name, std::size_t(coarsest_.plane) * count);
    std::size_t first = 0;
    for (std::size_t i = first_coarsest_; i < levels_.size(); ++i) {
        const std::size_t plane = levels_[i].system.grid.plane;
        part(levels_[i]) = all.part(first * bytes, plane * bytes);
        first += plane;
    }
}

void Multigrid::allocate_weights_of_coarsest(std::uint32_t planes) {
    if (coarsest_.weight_planes == planes)
        return;
    coarsest_.weight_planes = planes;
    make_coarsest(coarsest_.weight_x, "weight_x", planes, [](Level &l) -> Buffer & { return l.system.weight_x; });
    make_coarsest(coarsest_.weight_y, "weight_y", planes, [](Level &l) -> Buffer & { return l.system.weight_y; });
    make_coarsest(coarsest_.weight_data, "weight_data", planes,
                  [](Level &l) -> Buffer & { return l.system.weight_data; });
    make_coarsest(coarsest_.inverse_diagonal, "inverse_diagonal", planes,
                  [](Level &l) -> Buffer & { return l.system.inverse_diagonal; });
    std::vector<solver_level> records;
    std::uint32_t first = 0;
    for (std::size_t i = first_coarsest_; i < levels_.size(); ++i) {
        System &system = levels_[i].system;
        const Grid &grid = system.grid;
        system.weight_plane = planes > 1 ? grid.plane : 0;
        records.push_back(
            {grid.width, grid.height, grid.row, grid.plane, first * together_, first * planes, system.weight_plane});
        first += grid.plane;
    }
    coarsest_.levels = Buffer(make_.device(), "levels", records.data(), records.size() * sizeof(solver_level));
}

void Multigrid::invert_diagonal(Kernels &kernels, System &system) {
    system.bind(kernels.invert_diagonal);
    system.grid.launch(kernels.invert_diagonal, {0, kernels.weight_planes});
}

void Multigrid::invert_finest_diagonal(Kernels &kernels) { invert_diagonal(kernels, system()); }

void Multigrid::set_uniform(Kernels &kernels, double data) {
    allocate();
    allocate_weights_of_coarsest(1);
    used_ = 0;
    for (Level &level : levels_) {
        System &system = level.system;
        // The mean of the right side is rounding error: the solution has none, and alpha^2 would not tame it. A single
        // pixel without weights stays at zero.
        system.data = &level == &levels_.back() ? 0 : data;
        if (!system.inverse_diagonal.valid())
            system.inverse_diagonal = make_.planes("inverse_diagonal", system.grid, 1);
        invert_diagonal(kernels, system);
        if (used_++ >= first_coarsest_) {
            system.bind(kernels.store_weights);
            system.grid.launch(kernels.store_weights, {});
        }
        if (data > dominant_data_weight && used_ > 1)
            break;
        data *= 4;
    }
}

void Multigrid::allocate_weights(std::uint32_t planes) {
    allocate();
    allocate_weights_of_coarsest(planes);
    for (std::size_t i = 0; i < first_coarsest_; ++i) {
        System &system = levels_[i].system;
        const std::uint32_t plane = planes > 1 ? system.grid.plane : 0;
        if (system.weight_x.valid() && system.weight_plane == plane)
            continue;
        system.weight_plane = plane;
        system.weight_x = make_.planes("weight_x", system.grid, planes);
        system.weight_y = make_.planes("weight_y", system.grid, planes);
        system.weight_data = make_.planes("weight_data", system.grid, planes);
        system.inverse_diagonal = make_.planes("inverse_diagonal", system.grid, planes);
    }
}

void Multigrid::coarsen_weights(Kernels &kernels) {
    used_ = levels_.size();
    invert_diagonal(kernels, levels_.front().system);
    for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
        const System &fine = levels_[i].system;
        System &coarse = levels_[i + 1].system;
        Kernel &kernel = kernels.coarsen_weights;
        fine.bind(kernel);
        kernel.set("coarse_weight_plane", coarse.weight_plane);
        kernel.bind("coarse_weight_x", coarse.weight_x);
        kernel.bind("coarse_weight_y", coarse.weight_y);
        kernel.bind("coarse_weight_data", coarse.weight_data);
        launch_transfer(kernel, fine.grid, coarse.grid, coarse.grid.height, {0, kernels.weight_planes});
        invert_diagonal(kernels, coarse);
    }
}

void Multigrid::cycle_coarsest(Kernels &kernels, Planes channels) {
    Kernel &kernel = kernels.coarse_cycle;
    kernel.set("first_channel", channels.first);
    kernel.set("level_count", static_cast<std::uint32_t>(used_ - first_coarsest_));
    kernel.set("lanes", tiles_.lanes());
    set_steps(kernel);
    kernel.bind(coarsest_.levels);
    kernel.bind(coarsest_.right_side);
    kernel.bind("smoothed", coarsest_.smoothed);
    kernel.bind("other", coarsest_.other);
    kernel.bind(coarsest_.weight_x);
    kernel.bind(coarsest_.weight_y);
    kernel.bind(coarsest_.weight_data);
    kernel.bind(coarsest_.inverse_diagonal);
    launch_groups(kernel, channels.count);
}

void Multigrid::go_down(Kernels &kernels, Planes channels) {
    const std::size_t fine = std::min(used_, first_coarsest_);
    for (std::size_t i = 0; i < fine; ++i) {
        const Level &level = levels_[i];
        Kernel &descend = kernels.descend;
        level.system.bind(descend);
        set_steps(descend);
        descend.bind(level.right_side);
        descend.bind("smoothed", level.smoothed);
        // The last grid's residual is asked for by nobody.
        const Level &next = levels_[i + 1];
        descend.bind("coarse", next.right_side);
        descend.set("coarse_row", next.system.grid.row);
        descend.set("coarse_plane", next.system.grid.plane);
        tiles_.launch(descend, level.system.grid, channels);
    }
    if (used_ > fine)
        cycle_coarsest(kernels, channels);
}

void Multigrid::prolong(Kernels &kernels, std::size_t level, Planes channels) {
    const Level &fine = levels_[level], &coarse = levels_[level + 1];
    Kernel &kernel = kernels.prolong;
    kernel.bind("coarse", coarse.smoothed);
    kernel.bind("coarse_left", coarse.system.column_left);
    kernel.bind("coarse_right", coarse.system.column_right);
    kernel.bind("u", fine.smoothed);
    launch_transfer(kernel, fine.system.grid, coarse.system.grid, fine.system.grid.height, channels);
}

void Multigrid::smooth_again(Kernels &kernels, std::size_t level, Planes channels, const Buffer *onto,
                             const Products *products) {
    Level &here = levels_[level];
    Kernel &ascend = kernels.ascend;
    here.system.bind(ascend);
    set_steps(ascend);
    ascend.bind(here.right_side);
    ascend.bind("u", here.smoothed);
    ascend.set("adds", bool(onto));
    ascend.bind("smoothed", onto ? *onto : here.other);
    ascend.set("multiplies", bool(products));
    ascend.bind("image", products ? products->image : here.right_side);
    if (products) {
        products->sums.bind_parts_of_eights(ascend, 2 * channels.count);
    } else {
        ascend.bind("partial", here.other);
        ascend.set("partials", 0);
    }
    tiles_.launch(ascend, here.system.grid, channels);
    if (!onto)
        std::swap(here.smoothed, here.other);
}

void Multigrid::go_up(Kernels &kernels, Planes channels, bool smooths_after, const Buffer *onto,
                      const Products *products) {
    for (std::size_t i = std::min(used_ - 1, first_coarsest_); i-- > 0;) {
        prolong(kernels, i, channels);
        if (smooths_after)
            smooth_again(kernels, i, channels, i == 0 ? onto : nullptr, i == 0 ? products : nullptr);
    }
}

void Multigrid::cycle(Kernels &kernels, Planes channels, bool smooths_after, const Products &products) {
    go_down(kernels, channels);
    go_up(kernels, channels, smooths_after, nullptr, &products);
    const auto &[sums, image, with_right_side, with_image] = products;
    if (smooths_after && used_ > 1)
        sums.sum_two(kernels, with_right_side, with_image, channels);
    else
        sums.products(kernels, channels, solution(), right_side(), image, with_right_side, with_image);
}

void Multigrid::cycle_onto(Kernels &kernels, Planes channels, const Buffer &u) {
    go_down(kernels, channels);
    go_up(kernels, channels, true, &u, nullptr);
}

} // namespace gradus::solver
