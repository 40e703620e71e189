// Whether PoCL vectorised a kernel.
#pragma once

#include "bench/kernels/captured_launch.h"

#include <optional>

namespace gradus::bench {

/// How many work-items PoCL runs in one vector; 1 where it did not vectorise the loop over them, nothing on another
/// device or where PoCL does not tell. Compiles the kernel once more, for only a compiler that runs makes remarks.
std::optional<int> pocl_vector_width(CapturedLaunch &launch);

} // namespace gradus::bench
