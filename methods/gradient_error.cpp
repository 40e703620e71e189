#include "methods/gradient_error.h"

#include <algorithm>
#include <vector>

namespace gradus {

namespace {

std::vector<float> solution(PoissonSolver &solver, const GradientFilms &film, PoissonOptions options) {
    if (film.frames() < 2) // one sample has no variance
        options.alpha_from_variances = false;
    const std::size_t pixels = film.pixels();
    std::vector<float> result(3 * pixels);
    solver.solve(film.images(), options, [&](std::uint32_t c, const float *plane) {
        std::copy_n(plane, pixels, result.begin() + std::ptrdiff_t(c * pixels));
    });
    return result;
}

} // namespace

SquaredErrors errors_of_solves(PoissonSolver &solver, const GradientFilms &films, const PoissonOptions &options) {
    const GradientFilms first = films.half(0), second = films.half(1);
    return errors_of_halves(solution(solver, first, options), solution(solver, second, options),
                            double(first.samples()) / double(films.samples()));
}

} // namespace gradus
