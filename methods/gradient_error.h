// The error of an image that one solve of all samples made: both halves are solved as it was. What L1 is biased by is
// not in it: the primal image, which has no bias, is so noisy that it would tell a tenth of the error at best.
#pragma once

#include "methods/gradient_films.h"
#include "solver/poisson_solver.h"
#include "solver/squared_errors.h"

namespace gradus {

/// `films` are halves, with a sample of each pixel at least; `options` is what all samples are solved with.
SquaredErrors errors_of_solves(PoissonSolver &solver, const GradientFilms &films, const PoissonOptions &options);

} // namespace gradus
