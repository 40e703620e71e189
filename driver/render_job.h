// One render from the scene file to the image: the loop over batches, time limit, interrupts and partial images.
#pragma once

#include "driver/method_request.h"
#include "driver/output_files.h"
#include "driver/scene_request.h"

#include <string>

namespace gradus {

struct RenderRequest {
    SceneRequest scene;
    MethodRequest method;
    OutputFiles outputs;
    double time_limit = 0;       ///< seconds of rendering; 0: none
    double until_error = 0;      ///< estimated relMSE to end by; 0: none
    double partial_interval = 0; ///< seconds between images so far; 0: none
    bool quiet = false;
};

/// Renders and writes. Returns ExitCode::success, or ExitCode::interrupted after a signal, when the image of the
/// samples so far was written, if there are any. Where there is no sample, no file is touched. Throws Error. That the
/// outputs can be written is checked before anything else.
int run_render(const RenderRequest &request, const Services &services);

} // namespace gradus
