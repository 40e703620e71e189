// Keeping PoCL from reading libraries that no kernel uses.
#pragma once

#include "runtime/device/device.h"

#include <filesystem>

namespace gradus {

/// Has PoCL 3.1 in this process link kernels by a script in `folder` that leaves out libm, libc and libgcc_s: to read
/// these takes most of a link, 15 of 18 ms for each kernel, and kernels call nothing that is there. One that does is
/// linked as before. Clang, which PoCL links by, looks for a linker in the folders of COMPILER_PATH first: so this is
/// for a process that only compiles. To be called before there are programs. Does nothing where that variable is set
/// already, where the script cannot be written, and for other implementations and versions.
void prepare_pocl_linker(const std::filesystem::path &folder, const DeviceDescription &description);

} // namespace gradus
