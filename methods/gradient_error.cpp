#include "methods/gradient_error.h"

#include <algorithm>
#include <array>

namespace gradus {

namespace {

std::vector<float> solution(PoissonSolver &solver, const GradientFilm &film, PoissonOptions options) {
    const auto mean = [&film](GradientFilm::Layer layer) {
        return [&film, layer](std::uint32_t c, float *plane) { mean_of(film, layer, c, plane); };
    };
    const auto variance = [&film](GradientFilm::Layer layer) {
        return [&film, layer](std::uint32_t c, float *plane) { variance_of(film, layer, c, plane); };
    };
    ImageSources images;
    images.primal = mean(GradientFilm::primal);
    images.dx = mean(GradientFilm::dx);
    images.dy = mean(GradientFilm::dy);
    images.primal_variance = variance(GradientFilm::primal);
    images.dx_variance = variance(GradientFilm::dx);
    images.dy_variance = variance(GradientFilm::dy);
    if (film.samples() < 2 * film.pixels()) // one sample has no variance
        options.alpha_from_variances = false;
    std::vector<float> result(3 * film.pixels());
    solver.solve(images, options, [&](std::uint32_t c, const float *plane) {
        std::copy_n(plane, film.pixels(), result.begin() + std::ptrdiff_t(c * film.pixels()));
    });
    return result;
}

} // namespace

SquaredErrors errors_of_solves(PoissonSolver &solver, const GradientFilms &films, const PoissonOptions &options) {
    const std::array<std::vector<float>, 2> solutions{solution(solver, films.half(0), options),
                                                      solution(solver, films.half(1), options)};
    return errors_of_halves(solutions[0], solutions[1], double(films.half(0).samples()) / double(films.samples()));
}

} // namespace gradus
