// Whether PoCL vectorised a kernel.
#pragma once

#include "bench/kernels/captured_launch.h"
#include "bench/kernels/measurements.h"

#include <map>
#include <string>
#include <utility>

namespace gradus::bench {

using KernelPlace = std::pair<std::string, std::string>; ///< file and name: two files may have kernels of one name

/// How many work-items PoCL runs in one vector, by kernel: 1 where it did not vectorise the loop over them. Empty on
/// another device. PoCL's compiler says so in remarks on stdout, if an environment variable was set when it was loaded;
/// so this runs the program again (`--parts remarks`, which prints them) and reads what that prints. Throws Error where
/// that fails.
std::map<KernelPlace, int> pocl_vector_widths(const Settings &settings);

/// Compiles the kernel anew, so that its compiler makes its remarks, between two lines that say which it is.
void print_remarks(CapturedLaunch &launch);

} // namespace gradus::bench
