// The kernel sources as they were at build time.
#pragma once

#include <string>
#include <vector>

namespace gradus {

struct EmbeddedKernel {
    std::string path; ///< from the project's root: "kernels/stages/camera.cl"
    std::string text;
};

const std::vector<EmbeddedKernel> &embedded_kernels();

} // namespace gradus
