#include "solver/reconstruction.h"

namespace gradus {

const char *reconstruction_name(Reconstruction reconstruction) {
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

const char *guide_name(Guide guide) { return guide == Guide::filter ? "filter" : "denoiser"; }

const char *accuracy_name(Accuracy accuracy) {
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
