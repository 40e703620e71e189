// The paths of the embedded kernel sources that are compiled, and not only included.
#pragma once

#include "runtime/device/embedded_kernels.h"

#include <string>
#include <vector>

namespace gradus::testing {

inline std::vector<std::string> stage_files() {
    std::vector<std::string> files;
    for (const EmbeddedKernel &file : embedded_kernels())
        if (file.path.ends_with(".cl"))
            files.push_back(file.path);
    return files;
}

} // namespace gradus::testing
