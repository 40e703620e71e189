// The layer `error`, and the estimate of relMSE that a render may end by: from what two halves of the samples tell of
// each pixel (solver/squared_errors.h).
//
// One pixel's halves tell next to nothing, so squared errors are means over neighbours, and noise that is rare and
// bright is known where it was met and around that. The number needs no neighbours: it is the mean over pixels of what
// they tell, relative to the image without its outliers, as relMSE is to a reference (runtime/film/metrics.h).
//
// A guide that is made of the noise of both halves follows it, by the weights that they share; that looks like less
// than no bias. So a bias that cannot be told from none counts as one standard error of its measure: with the feature
// filter that brings estimates to within a factor of two or three (docs/design.md).
#pragma once

#include "methods/method.h"
#include "runtime/film/image.h"
#include "solver/squared_errors.h"

namespace gradus {

/// Whether an image gets the layer: where it is asked for, and with the other layers where there are halves in any
/// case.
inline bool has_error_layer(const RenderOptions &options, bool halves) {
    return options.error || (options.aov && halves);
}

/// Throws Error(ExitCode::usage) where a method that does not estimate its error is asked to.
void check_error(const RenderOptions &options, const char *method);

/// Adds error.R, error.G and error.B to the image that `errors` are of: estimated root mean square errors. Returns the
/// estimated relMSE; nothing where no value is known.
std::optional<double> add_error_layer(Image &image, const SquaredErrors &errors);

} // namespace gradus
