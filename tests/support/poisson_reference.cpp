#include "tests/support/poisson_reference.h"
#include "tests/support/worse.h"

#include <fftw3.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <span>

namespace gradus::testing {

namespace {

double dot(std::span<const double> a, std::span<const double> b) {
    // Eight sums at a time: additions wait for each other.
    double sums[8] = {};
    std::size_t i = 0;
    for (; i + 8 <= a.size(); i += 8)
        for (std::size_t k = 0; k < 8; ++k)
            sums[k] += a[i + k] * b[i + k];
    for (; i < a.size(); ++i)
        sums[0] += a[i] * b[i];
    return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

/// The inputs in double, zero where they are missing.
struct Inputs {
    std::vector<double> primal, dx, dy;
};

double known(float value) { return std::isfinite(value) ? double(value) : 0.0; }

Inputs known_inputs(const PoissonProblem &problem) {
    Inputs inputs;
    for (std::size_t i = 0; i < problem.primal.size(); ++i) {
        inputs.primal.push_back(known(problem.primal[i]));
        inputs.dx.push_back(known(problem.dx[i]));
        inputs.dy.push_back(known(problem.dy[i]));
    }
    return inputs;
}

/// Calls visit(from, to, is_x) for each edge of a channel, by its pixels' indices.
template <class Visit>
void for_each_edge(const PoissonProblem &problem, std::uint32_t channel, Visit visit) {
    for (std::uint32_t y = 0; y < problem.height; ++y)
        for (std::uint32_t x = 0; x < problem.width; ++x) {
            const std::size_t i = problem.at(channel, x, y);
            if (x + 1 < problem.width)
                visit(i, i + 1, true);
            if (y + 1 < problem.height)
                visit(i, i + problem.width, false);
        }
}

/// Residuals of all equations, those of the primal times alpha. Zero where an input is missing.
Inputs residuals(const PoissonProblem &problem, double alpha, const PoissonWeights &units,
                 const std::vector<double> &image) {
    const Inputs inputs = known_inputs(problem);
    Inputs e{std::vector<double>(image.size()), std::vector<double>(image.size()), std::vector<double>(image.size())};
    for (std::uint32_t c = 0; c < problem.channels; ++c)
        for_each_edge(problem, c, [&](std::size_t i, std::size_t j, bool is_x) {
            (is_x ? e.dx : e.dy)[i] =
                (is_x ? units.dx : units.dy)[i] * (image[j] - image[i] - (is_x ? inputs.dx : inputs.dy)[i]);
        });
    for (std::size_t i = 0; i < image.size(); ++i)
        e.primal[i] = units.primal[i] * alpha * (image[i] - inputs.primal[i]);
    return e;
}

/// Absolute values, or norms over the channels of a pixel.
std::vector<double> magnitudes(const PoissonProblem &problem, const std::vector<double> &e, bool joint) {
    std::vector<double> result(e.size());
    for (std::size_t i = 0; i < e.size(); ++i)
        result[i] = std::abs(e[i]);
    if (!joint)
        return result;
    for (std::size_t pixel = 0; pixel < problem.pixels(); ++pixel) {
        double squares = 0;
        for (std::size_t i = pixel; i < e.size(); i += problem.pixels())
            squares += e[i] * e[i];
        for (std::size_t i = pixel; i < e.size(); i += problem.pixels())
            result[i] = std::sqrt(squares);
    }
    return result;
}

/// Weights 1 / (|e| + reg) for each equation that is there, reg relative to the mean |e|.
PoissonWeights l1_weights(const PoissonProblem &problem, const PoissonWeights &units, const Inputs &e, bool joint,
                          double relative_reg) {
    PoissonWeights w{magnitudes(problem, e.primal, joint), magnitudes(problem, e.dx, joint),
                     magnitudes(problem, e.dy, joint)};
    double sum = 0, count = 0;
    const std::pair<std::vector<double> *, const std::vector<double> *> parts[] = {
        {&w.primal, &units.primal}, {&w.dx, &units.dx}, {&w.dy, &units.dy}};
    for (const auto &[part, unit] : parts)
        for (std::size_t i = 0; i < part->size(); ++i) {
            sum += (*part)[i];
            count += (*unit)[i];
        }
    const double reg = relative_reg * sum / std::max(count, 1.0);
    for (const auto &[part, unit] : parts)
        for (std::size_t i = 0; i < part->size(); ++i)
            (*part)[i] = (*unit)[i] > 0 ? 1 / ((*part)[i] + std::max(reg, 1e-300)) : 0;
    return w;
}

/// One channel of the weighted system in u = I - start: its matrix, and its right side for that start.
class System {
  public:
    System(const PoissonProblem &problem, std::uint32_t channel, double alpha, const PoissonWeights &weights)
        : problem_(problem), first_(channel * problem.pixels()), alpha_(alpha), weights_(weights) {}

    /// result = A u. Edges that leave the image have weight 0, so it does not matter to which pixel they lead.
    void apply(const std::vector<double> &u, std::vector<double> &result) const {
        const std::size_t w = problem_.width, n = w * problem_.height;
        const double *wx = &weights_.dx[first_], *wy = &weights_.dy[first_], *wp = &weights_.primal[first_];
        const auto at = [&](std::size_t i, std::size_t left, std::size_t right, std::size_t up, std::size_t down) {
            return alpha_ * alpha_ * wp[i] * u[i] + wx[i] * (u[i] - u[right]) + wx[left] * (u[i] - u[left]) +
                   wy[i] * (u[i] - u[down]) + wy[up] * (u[i] - u[up]);
        };
        const auto apply_carefully = [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                result[i] = at(i, i >= 1 ? i - 1 : i, i + 1 < n ? i + 1 : i, i >= w ? i - w : i, i + w < n ? i + w : i);
        };
        const std::size_t first = std::min(n, w), last = std::max(first, n - w);
        apply_carefully(0, first);
        for (std::size_t i = first; i < last; ++i)
            result[i] = at(i, i - 1, i + 1, i - w, i + w);
        apply_carefully(last, n);
    }

    /// The diagonal of A.
    std::vector<double> diagonal() const {
        const std::size_t w = problem_.width, n = w * problem_.height;
        const double *wx = &weights_.dx[first_], *wy = &weights_.dy[first_], *wp = &weights_.primal[first_];
        std::vector<double> result(n);
        for (std::size_t i = 0; i < n; ++i)
            result[i] = alpha_ * alpha_ * wp[i] + wx[i] + wy[i] + (i >= 1 ? wx[i - 1] : 0) + (i >= w ? wy[i - w] : 0);
        return result;
    }

    /// -A^T W e, e being the residuals of `image` without weights, those of the primal not times alpha.
    std::vector<double> right_side(const Inputs &inputs, const std::vector<double> &image) const {
        std::vector<double> b(problem_.pixels());
        const auto channel = std::uint32_t(first_ / problem_.pixels());
        for_each_edge(problem_, channel, [&](std::size_t i, std::size_t j, bool is_x) {
            const double flow =
                (is_x ? weights_.dx : weights_.dy)[i] * ((is_x ? inputs.dx : inputs.dy)[i] - (image[j] - image[i]));
            b[i - first_] -= flow;
            b[j - first_] += flow;
        });
        for (std::size_t i = 0; i < b.size(); ++i)
            b[i] += alpha_ * alpha_ * weights_.primal[first_ + i] * (inputs.primal[first_ + i] - image[first_ + i]);
        return b;
    }

  private:
    const PoissonProblem &problem_;
    std::size_t first_;
    double alpha_;
    const PoissonWeights &weights_;
};

/// u from 0. Preconditioned by the diagonal, for weights of L1 differ by many powers of ten.
std::vector<double> conjugate_gradients(const System &system, std::vector<double> residual, int steps,
                                        double tolerance) {
    std::vector<double> inverse = system.diagonal();
    for (double &one : inverse)
        one = one > 0 ? 1 / one : 0;
    std::vector<double> u(residual.size()), scaled(residual.size()), product(residual.size());
    const auto scale = [&] {
        for (std::size_t i = 0; i < scaled.size(); ++i)
            scaled[i] = inverse[i] * residual[i];
        return dot(residual, scaled);
    };
    double progress = scale();
    std::vector<double> direction = scaled;
    const double enough = tolerance * tolerance * dot(residual, residual);
    for (int k = 0; k < steps && progress > 0 && dot(residual, residual) > enough; ++k) {
        system.apply(direction, product);
        const double step = progress / dot(direction, product);
        for (std::size_t i = 0; i < u.size(); ++i) {
            u[i] += step * direction[i];
            residual[i] -= step * product[i];
        }
        const double next = scale();
        for (std::size_t i = 0; i < u.size(); ++i)
            direction[i] = scaled[i] + next / progress * direction[i];
        progress = next;
    }
    return u;
}

} // namespace

PoissonWeights unit_weights(const PoissonProblem &problem) {
    const std::size_t size = problem.primal.size();
    PoissonWeights w{std::vector<double>(size, 1.0), std::vector<double>(size), std::vector<double>(size)};
    for (std::uint32_t c = 0; c < problem.channels; ++c)
        for_each_edge(problem, c, [&](std::size_t i, std::size_t, bool is_x) { (is_x ? w.dx : w.dy)[i] = 1; });
    const auto drop_missing = [&](const std::vector<float> &input, std::vector<double> &weight) {
        for (std::size_t i = 0; i < size; ++i)
            for (std::size_t j = i % problem.pixels(); j < size; j += problem.pixels())
                if (!std::isfinite(input[j]))
                    weight[i] = 0;
    };
    drop_missing(problem.primal, w.primal);
    drop_missing(problem.dx, w.dx);
    drop_missing(problem.dy, w.dy);
    return w;
}

std::vector<double> solve_directly(const PoissonProblem &problem, double alpha) {
    const auto width = int(problem.width), height = int(problem.height);
    const std::size_t pixels = problem.pixels();
    const Inputs inputs = known_inputs(problem);
    const PoissonWeights units = unit_weights(problem);
    const std::unique_ptr<double[], decltype(&fftw_free)> plane(fftw_alloc_real(pixels), &fftw_free);
    const fftw_plan forward =
        fftw_plan_r2r_2d(height, width, plane.get(), plane.get(), FFTW_REDFT10, FFTW_REDFT10, FFTW_ESTIMATE);
    const fftw_plan backward =
        fftw_plan_r2r_2d(height, width, plane.get(), plane.get(), FFTW_REDFT01, FFTW_REDFT01, FFTW_ESTIMATE);
    std::vector<double> image = inputs.primal;
    for (std::uint32_t c = 0; c < problem.channels; ++c) {
        const std::vector<double> b = System(problem, c, alpha, units).right_side(inputs, inputs.primal);
        std::copy(b.begin(), b.end(), plane.get());
        fftw_execute(forward);
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) {
                const double eigenvalue = alpha * alpha + 4 - 2 * std::cos(std::numbers::pi * i / width) -
                                          2 * std::cos(std::numbers::pi * j / height);
                double &coefficient = plane[std::size_t(j) * std::size_t(width) + std::size_t(i)];
                // The right side has mean 0: differences telescope. What is left of it is rounding.
                coefficient = i == 0 && j == 0 ? 0 : coefficient / eigenvalue;
            }
        fftw_execute(backward);
        for (std::size_t i = 0; i < pixels; ++i)
            image[c * pixels + i] += plane[i] / (4.0 * double(pixels));
    }
    fftw_destroy_plan(forward);
    fftw_destroy_plan(backward);
    return image;
}

std::vector<double> solve_weighted(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                                   const std::vector<double> &start, int steps, double tolerance) {
    const Inputs inputs = known_inputs(problem);
    std::vector<double> image = start;
    for (std::uint32_t c = 0; c < problem.channels; ++c) {
        const System system(problem, c, alpha, weights);
        const std::vector<double> u = conjugate_gradients(system, system.right_side(inputs, start), steps, tolerance);
        for (std::size_t i = 0; i < u.size(); ++i)
            image[c * problem.pixels() + i] += u[i];
    }
    return image;
}

double l2_objective(const PoissonProblem &problem, double alpha, const std::vector<double> &image) {
    const Inputs e = residuals(problem, alpha, unit_weights(problem), image);
    return dot(e.primal, e.primal) + dot(e.dx, e.dx) + dot(e.dy, e.dy);
}

double l1_objective(const PoissonProblem &problem, double alpha, const std::vector<double> &image, bool joint) {
    const Inputs e = residuals(problem, alpha, unit_weights(problem), image);
    double sum = 0;
    for (const std::vector<double> *part : {&e.primal, &e.dx, &e.dy})
        for (const double magnitude : magnitudes(problem, *part, joint))
            sum += magnitude;
    return joint ? sum / problem.channels : sum; // a norm over channels stands there for each of them
}

double residual_norm(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                     const std::vector<double> &image) {
    const Inputs inputs = known_inputs(problem);
    double squares = 0;
    for (std::uint32_t c = 0; c < problem.channels; ++c) {
        const std::vector<double> r = System(problem, c, alpha, weights).right_side(inputs, image);
        squares += dot(r, r);
    }
    return std::sqrt(squares);
}

double relative_residual(const PoissonProblem &problem, double alpha, const PoissonWeights &weights,
                         const std::vector<double> &image) {
    return residual_norm(problem, alpha, weights, image) /
           residual_norm(problem, alpha, weights, known_inputs(problem).primal);
}

std::vector<double> solve_l1(const PoissonProblem &problem, double alpha, bool joint, int reweightings, int steps) {
    const PoissonWeights units = unit_weights(problem);
    std::vector<double> image = solve_weighted(problem, alpha, units, known_inputs(problem).primal, steps, 1e-15);
    std::vector<double> best = image;
    double least = l1_objective(problem, alpha, image, joint), reg = 0.05;
    for (int k = 1; k < reweightings; ++k, reg *= 0.5) {
        const Inputs e = residuals(problem, alpha, units, image);
        const PoissonWeights w = l1_weights(problem, units, e, joint, reg);
        image = solve_weighted(problem, alpha, w, image, steps, 1e-3);
        if (const double objective = l1_objective(problem, alpha, image, joint); objective < least) {
            least = objective;
            best = image;
        }
    }
    return best;
}

Bracket bracket_least_l1(const PoissonProblem &problem, double alpha, bool joint) {
    const PoissonWeights units = unit_weights(problem);
    const Inputs inputs = known_inputs(problem);
    std::vector<double> image = inputs.primal;
    Bracket bracket{0, l1_objective(problem, alpha, image, joint)};
    for (int k = 0; k < 300; ++k) {
        // With reg fixed, reweighting converges: y = W e then has |y| < 1 and A^T y = 0, and y . e is near sum |e|.
        const double reg = k < 100 ? 1e-2 : k < 200 ? 1e-3 : 1e-4;
        const PoissonWeights w = l1_weights(problem, units, residuals(problem, alpha, units, image), joint, reg);
        image = solve_weighted(problem, alpha, w, image, 20000, 1e-10);
        bracket.most = std::min(bracket.most, l1_objective(problem, alpha, image, joint));
        Inputs y = residuals(problem, alpha, units, image);
        for (std::size_t i = 0; i < image.size(); ++i) {
            y.dx[i] *= w.dx[i];
            y.dy[i] *= w.dy[i];
            y.primal[i] = 0;
        }
        // The equations of the primal give what A^T y = 0 asks of the rest, exactly.
        for (std::uint32_t c = 0; c < problem.channels; ++c)
            for_each_edge(problem, c, [&](std::size_t i, std::size_t j, bool is_x) {
                const double flow = (is_x ? y.dx : y.dy)[i] / alpha;
                y.primal[i] += flow;
                y.primal[j] -= flow;
            });
        double largest = 1;
        for (const std::vector<double> *part : {&y.primal, &y.dx, &y.dy})
            for (const double magnitude : magnitudes(problem, *part, joint))
                largest = worse(largest, magnitude);
        const double bound = -dot(y.dx, inputs.dx) - dot(y.dy, inputs.dy) - alpha * dot(y.primal, inputs.primal);
        bracket.least = std::max(bracket.least, bound / largest);
    }
    return bracket;
}

std::vector<double> to_double(const std::vector<float> &values) { return {values.begin(), values.end()}; }

std::vector<float> to_float(const std::vector<double> &values) { return {values.begin(), values.end()}; }

double relative_error(const std::vector<double> &a, const std::vector<double> &b) {
    double error = 0, norm = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        error += (a[i] - b[i]) * (a[i] - b[i]);
        norm += b[i] * b[i];
    }
    return std::sqrt(error / norm);
}

double relative_error(const std::vector<float> &a, const std::vector<double> &b) {
    return relative_error(to_double(a), b);
}

} // namespace gradus::testing
