#include "solver/linear_solver.h"

#include "kernels/shared/solver_shared.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gradus::solver {

namespace {

/// A residual that is read back waits for the device. That is cheap where the host is the device, and against a cycle
/// of the hierarchy; elsewhere only every so many iterations are looked at, and the solve may do that many more than it
/// needs.
constexpr int iterations_between_looks = 8;

constexpr std::uint32_t history_slots = SOLVER_SCALAR_SLOTS - SOLVER_HISTORY;

/// Conjugate gradients compute their residual anew after so many steps, which keeps rounding errors from adding up.
constexpr int steps_between_true_residuals = 50;

/// And forget their directions after so many, as those are no longer conjugate; earlier would lose what they have
/// learnt of the spectrum.
constexpr int steps_between_fresh_directions = 400;

/// Preconditioned, steps and beta are about 1. What is far more comes from rounding errors, where nothing is left to
/// do.
constexpr double largest_preconditioned_ratio = 8;

constexpr int stagnating_cycles = 4;

/// Of the right side: in single precision less is hardly reached.
constexpr double small_residual = 1e-5;

} // namespace

/// Follows the residuals of a group, and says when to stop. Iteration k leaves its squared norm in slot(k); where
/// errors are compared with noise, the next step leaves what <z, r> says of the error.
struct LinearSolver::Progress {
    Sums &sums;
    const Request &request;
    Planes channels;
    double reference_norm;
    double least_tolerance; ///< less is rounding errors alone
    bool looks_at_each;     ///< iteration
    /// Keeps a channel, counted within the group, as it is in the buffer.
    std::function<void(std::uint32_t, const Buffer &)> keep;
    int iterations = 0;
    struct Channel {
        std::vector<double> norms;                              ///< residuals, or the roots of the errors
        double least = std::numeric_limits<double>::infinity(); ///< of them
        bool finished = false, converged = false, is_kept = false;
    };
    std::vector<Channel> of = std::vector<Channel>(channels.count);

    static std::uint32_t slot(int iteration) { return SOLVER_HISTORY + std::uint32_t(iteration) % history_slots; }

    bool compares_with_noise() const { return request.noise > 0; }

    /// To be called after iteration `done` (0: the start) left its norm; true where no more is needed. `u`: the
    /// solution so far.
    bool finished(int done, const Buffer &u) {
        iterations = done;
        const bool last = done >= request.iterations;
        if (!request.watch)
            return last;
        const int known = compares_with_noise() ? done - 1 : done; // number of the last norm
        if (known < 0 || (!last && done % (looks_at_each ? 1 : iterations_between_looks) != 0))
            return false;
        for (std::uint32_t c = 0; c < channels.count; ++c)
            if (!of[c].finished)
                look(of[c], known, channels.first + c);
        const bool all =
            last || std::all_of(of.begin(), of.end(), [](const Channel &channel) { return channel.finished; });
        // The others go on, and take along what needs no more: it is to stay as it is now.
        for (std::uint32_t c = 0; c < channels.count && !all; ++c)
            if (of[c].finished && !of[c].is_kept) {
                keep(c, u);
                of[c].is_kept = true;
            }
        return all;
    }

    void look(Channel &channel, int known, std::uint32_t number) {
        std::vector<double> &norms = channel.norms;
        while (int(norms.size()) <= known) { // <z, r> may be below 0 where rounding errors are all that is left
            norms.push_back(std::sqrt(std::abs(sums.read(slot(int(norms.size())), number))));
            channel.least = std::min(channel.least, norms.back());
        }
        // From u = 0, the first residual is b itself.
        const double norm = reference_norm > 0 ? reference_norm : norms.front();
        channel.converged = norms.back() <= std::max(request.tolerance, least_tolerance) * norm;
        channel.finished =
            channel.converged || !std::isfinite(norms.back()) || stagnates(norms) || drifts(channel, norm);
    }

    /// Rounding errors are all that is left: a cycle that works divides the residual by ten.
    bool stagnates(const std::vector<double> &norms) const {
        return request.method == LinearMethod::multigrid && int(norms.size()) > stagnating_cycles &&
               norms.back() > 0.7 * norms[norms.size() - 1 - stagnating_cycles];
    }

    /// The same of preconditioned steps, where the mean of the solution is next to free.
    bool drifts(const Channel &channel, double norm) const {
        return request.may_drift && request.method == LinearMethod::pcg && channel.least <= small_residual * norm &&
               channel.norms.back() > 2 * channel.least;
    }
};

LinearSolver::LinearSolver(const PlaneMaker &make, Multigrid &multigrid, Sums &sums, std::uint32_t together)
    : make_(make), multigrid_(multigrid), sums_(sums), together_(together) {}

void LinearSolver::run(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress) {
    switch (progress.request.method) {
    case LinearMethod::jacobi:
        jacobi(kernels, b, u, progress);
        break;
    case LinearMethod::cg:
        conjugate_gradients(kernels, false, b, u, progress);
        break;
    case LinearMethod::pcg:
        conjugate_gradients(kernels, true, b, u, progress);
        break;
    case LinearMethod::multigrid:
    case LinearMethod::automatic:
        multigrid(kernels, b, u, progress);
        break;
    }
    for (std::uint32_t c = 0; c < progress.channels.count; ++c)
        if (progress.of[c].is_kept)
            copy(kernels, kept_, u, {c, 1});
}

LinearReport LinearSolver::solve(Kernels &kernels, const Request &request, const std::vector<Planes> &groups,
                                 const RightSide &b, const Buffer &u, double reference_norm) {
    const bool looks_at_each = make_.device().description().is_host ||
                               (request.method != LinearMethod::jacobi && request.method != LinearMethod::cg);
    const double epsilon = make_.precision() == Precision::double_ ? std::numeric_limits<double>::epsilon()
                                                                   : std::numeric_limits<float>::epsilon();
    const Grid &grid = multigrid_.system().grid;
    const auto keep = [&](std::uint32_t channel, const Buffer &now) {
        if (!kept_.valid())
            kept_ = make_.planes("u", grid, together_);
        copy(kernels, now, kept_, {channel, 1});
    };
    if (request.noise > 0)
        reference_norm = std::sqrt(request.noise);
    LinearReport report;
    report.converged = request.watch;
    std::vector<std::vector<double>> norms;
    std::size_t count = 0; // of norms
    for (const Planes group : groups) {
        Progress progress{sums_, request, group, reference_norm, epsilon / 64, looks_at_each, keep};
        run(kernels, b(group), make_.some(u, grid, group), progress);
        report.iterations = std::max(report.iterations, progress.iterations);
        for (Progress::Channel &channel : progress.of) {
            report.converged = report.converged && channel.converged;
            count = std::max(count, channel.norms.size());
            norms.push_back(std::move(channel.norms));
        }
    }
    if (!request.watch)
        return report;
    double whole = 0;
    for (const std::vector<double> &of : norms)
        whole += reference_norm > 0 ? reference_norm * reference_norm : of.front() * of.front();
    for (std::size_t i = 0; i < count; ++i) {
        double squares = 0;
        for (const std::vector<double> &of : norms) {
            const double residual = of[std::min(i, of.size() - 1)];
            squares += residual * residual;
        }
        report.residuals.push_back(whole > 0 ? std::sqrt(squares / whole) : 0);
    }
    return report;
}

void LinearSolver::improve(Kernels &kernels, Request request, Planes group, const Buffer &b, const Buffer &u) {
    request.watch = false;
    Progress progress{sums_, request, group, 0, 0, true, {}};
    run(kernels, b, u, progress);
}

void LinearSolver::copy(Kernels &kernels, const Buffer &from, const Buffer &to, Planes planes) {
    const Grid &grid = multigrid_.system().grid;
    // The kernel counts planes from the first of the buffer; parts of buffers must be there when it is launched.
    const Buffer some_from = make_.some(from, grid, planes), some_to = make_.some(to, grid, planes);
    kernels.copy.bind("from", some_from);
    kernels.copy.bind("to", some_to);
    grid.launch(kernels.copy, planes);
}

/// The hierarchy's right side = b - A u.
void LinearSolver::residual(Kernels &kernels, const Buffer &b, const Buffer &u, Planes channels) {
    Kernel &kernel = kernels.residual;
    multigrid_.system().bind(kernel);
    kernel.bind("u", u);
    kernel.bind("right_side", b);
    kernel.bind("residual", multigrid_.right_side());
    multigrid_.system().grid.launch(kernel, channels);
}

void LinearSolver::jacobi(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress) {
    const Grid &grid = multigrid_.system().grid;
    if (!other_.valid())
        other_ = make_.planes("u", grid, together_);
    Kernel &kernel = kernels.smooth;
    const Buffer *from = &u, *to = &other_;
    for (int done = 0;; ++done, std::swap(from, to)) {
        const Buffer &r = multigrid_.right_side();
        if (progress.request.watch) {
            residual(kernels, b, *from, progress.channels);
            sums_.product(kernels, progress.channels, r, r, Progress::slot(done));
        }
        if (progress.finished(done, *from))
            break;
        multigrid_.system().bind(kernel);
        kernel.set_real("step_size", progress.request.damping);
        kernel.bind("u", *from);
        kernel.bind("right_side", b);
        kernel.bind("smoothed", *to);
        grid.launch(kernel, progress.channels);
    }
    if (from != &u)
        copy(kernels, other_, u, {0, progress.channels.count});
}

void LinearSolver::multigrid(Kernels &kernels, const Buffer &b, const Buffer &u, Progress &progress) {
    const Buffer &r = multigrid_.right_side();
    for (int done = 0;; ++done) {
        if (progress.request.watch || done < progress.request.iterations)
            residual(kernels, b, u, progress.channels);
        if (progress.request.watch)
            sums_.product(kernels, progress.channels, r, r, Progress::slot(done));
        if (progress.finished(done, u))
            return;
        multigrid_.cycle_onto(kernels, progress.channels, u);
    }
}

void LinearSolver::conjugate_gradients(Kernels &kernels, bool preconditioned, const Buffer &b, const Buffer &u,
                                       Progress &progress) {
    const Grid &grid = multigrid_.system().grid;
    const Planes channels = progress.channels;
    if (!image_.valid()) {
        for (Buffer &direction : directions_)
            direction = make_.planes("direction", grid, together_);
        image_ = make_.planes("image", grid, together_);
    }
    const Buffer &r = multigrid_.right_side(); // which is what a cycle is given
    const double bound = preconditioned ? largest_preconditioned_ratio : std::numeric_limits<float>::max();
    const bool compares = progress.compares_with_noise();
    // Plain conjugate gradients need the norm for beta, too.
    const bool norms = (progress.request.watch && !compares) || !preconditioned;
    for (int done = 0;; ++done) {
        if (done % steps_between_true_residuals == 0)
            residual(kernels, b, u, channels);
        if (norms)
            sums_.product(kernels, channels, r, r, Progress::slot(done));
        if (progress.finished(done, u))
            return;
        std::uint32_t numerator = Progress::slot(done), divisor = Progress::slot(std::max(done - 1, 0));
        std::uint32_t step = preconditioned && !compares ? std::uint32_t(slot_residual_product) : Progress::slot(done);
        if (preconditioned) {
            // The cycle is not symmetric, so beta is that of Polak and Ribiere: <z, r - r_old> / <z_old, r_old>, where
            // r - r_old = -alpha image, so beta = -<z, image> / <direction, image> (Notay 2000).
            multigrid_.cycle(kernels, channels, progress.request.smooths_after,
                             {sums_, image_, step, slot_image_product});
            numerator = slot_image_product;
            divisor = slot_direction_product;
        }
        const bool is_fresh = done % steps_between_fresh_directions == 0;
        const Buffer &z = preconditioned ? multigrid_.solution() : r;
        Kernel &direction = kernels.direction;
        multigrid_.system().bind(direction);
        sums_.bind_scalars(direction);
        direction.set_real("factor", is_fresh ? 0 : preconditioned ? -1 : 1);
        direction.set_real("bound", bound);
        direction.set("numerator", numerator);
        direction.set("divisor", divisor);
        direction.bind("z", z);
        direction.bind("old_direction", is_fresh ? z : directions_[(done + 1) % 2]); // times 0, and may be no number
        direction.bind("direction", directions_[done % 2]);
        direction.bind("image", image_);
        sums_.bind_parts_of_eights(direction, channels.count);
        multigrid_.tiles().launch(direction, grid, channels);
        sums_.sum(kernels, slot_direction_product, channels);

        Kernel &advance = kernels.advance;
        sums_.bind_scalars(advance);
        advance.set_real("bound", bound);
        advance.set("numerator", step);
        advance.set("divisor", slot_direction_product);
        advance.bind("direction", directions_[done % 2]);
        advance.bind("image", image_);
        advance.bind("u", u);
        advance.bind("residual", r);
        grid.launch(advance, channels);
    }
}

} // namespace gradus::solver
