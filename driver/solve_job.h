// One solve from the files that it reads to the image that it writes.
#pragma once

#include "driver/gradient_layers.h"
#include "driver/output_files.h"
#include "driver/services.h"

#include <cstdint>
#include <optional>
#include <string>

namespace gradus {

struct SolveRequest {
    GradientSources sources;
    OutputFiles outputs;
    PoissonOptions options;
    Reconstruction reconstruction = Reconstruction::l1;
    bool reconstruction_is_given = false;
    std::optional<Guide> guide; ///< of Reconstruction::guided; without one, the filter
    bool alpha_is_given = false;
    std::optional<double> damping;
    std::string device; ///< Device's selector
    int threads = 0;    ///< 0: all
    int repeats = 1;    ///< solves so often; the figures are the last one's
    bool quiet = false;
};

/// Reads, solves and writes. Returns ExitCode::success. Throws Error. Outputs are checked before anything is read,
/// images before a device is opened.
int run_solve(SolveRequest request, const Services &services);

/// Throws Error(ExitCode::device) for images that the device cannot hold: each is one buffer.
void check_images_fit(const DeviceDescription &device, std::uint32_t width, std::uint32_t height,
                      std::uint32_t channels);

} // namespace gradus
