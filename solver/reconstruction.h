// How an image is made of samples and differences.
#pragma once

#include "solver/poisson_solver.h"

namespace gradus {

enum class Reconstruction {
    l1,       ///< PoissonNorm::l1: robust, and consistent
    l2,       ///< PoissonNorm::l2, one weight for all pixels
    weighted, ///< least squares, each equation by its variance; two halves judge each other (weighted_reconstruction.h)
    guided    ///< the same, and a guide image where it has less error (guide/guide_judge.h)
};

/// What makes the guide of Reconstruction::guided.
enum class Guide {
    filter,  ///< a feature filter of our own (guide/feature_filter.h)
    denoiser ///< Open Image Denoise, where it is installed (guide/denoiser.h)
};
constexpr const char *guide_name(Guide guide) { return guide == Guide::filter ? "filter" : "denoiser"; }

/// Whether samples must be kept as two halves.
constexpr bool needs_halves(Reconstruction reconstruction) {
    return reconstruction == Reconstruction::weighted || reconstruction == Reconstruction::guided;
}

/// As --reconstruction names it.
inline const char *reconstruction_name(Reconstruction reconstruction) {
    switch (reconstruction) {
    case Reconstruction::l1:
        return "l1";
    case Reconstruction::l2:
        return "l2";
    case Reconstruction::weighted:
        return "weighted";
    case Reconstruction::guided:
        return "guided";
    }
    return "";
}

/// What the mean of many renders tends to.
enum class Accuracy {
    unbiased,   ///< to what is right
    consistent, ///< to what is right as samples grow
    neither
};
inline const char *accuracy_name(Accuracy accuracy) {
    switch (accuracy) {
    case Accuracy::unbiased:
        return "unbiased";
    case Accuracy::consistent:
        return "consistent";
    case Accuracy::neither:
        return "neither";
    }
    return "";
}

} // namespace gradus
