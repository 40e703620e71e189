// From the sums of a gradient-domain method to its image.
#pragma once

#include "methods/gradient_films.h"
#include "methods/method.h"
#include "runtime/device/program.h"
#include "runtime/direct_light/direct_light.h"
#include "runtime/film/image.h"
#include "solver/poisson_solver.h"

#include <functional>
#include <optional>
#include <vector>

namespace gradus {

/// What an image that says its error has been given for that, and says.
struct ErrorOfImage {
    std::vector<float> direct_variance; ///< of what the camera sees of lights, as SquaredErrors has it
    std::optional<double> relative;     ///< the estimate of relMSE; nothing where halves have no samples
};

/// `whole`, the mean of all samples, with R, G and B reconstructed; with `layers` also those that they were made from,
/// and in the metadata how many samples these have.
/// What `whole` has and the primal has not is what the camera sees of lights, and `edges` know it better where they
/// are; it is added at last, as it is. alpha comes from the variances unless the options say otherwise. `films` are
/// two where options need halves; they go once they have been read, and then `films_are_read` is called, before the
/// solver needs its memory. `used`: how it was done. `error`: where given and halves have samples, the image gets the
/// layer of errors.
Image reconstruct(Device &device, PoissonSolver &solver, Image whole, GradientFilms films,
                  const std::vector<DirectPixel> &edges, const RenderOptions &options, bool layers,
                  const std::function<void()> &films_are_read, ReconstructionUsed &used, ErrorOfImage *error = nullptr);

/// Compiles what reconstructing so many frames needs; as PoissonSolver::compile().
void compile_reconstruction(Device &device, const RenderOptions &options, std::uint64_t frames,
                            const KernelLibrary::Progress &progress = {});

/// What options ask of the solver.
PoissonOptions poisson_options(const RenderOptions &options, std::uint64_t frames);

} // namespace gradus
