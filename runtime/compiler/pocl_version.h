// Which PoCL is at work in this process.
#pragma once

#include "runtime/device/loaded_library.h"

namespace gradus {

/// By the name of its library, which is known before there is a device.
inline bool is_pocl_3_1_loaded() { return loaded_library("libpocl.so.2.10"); }

} // namespace gradus
