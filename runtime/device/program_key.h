// What the code of a program depends on.
#pragma once

#include "runtime/device/device.h"

#include <string>

namespace gradus {

/// Device, driver, and on a CPU the processor and the variables by which PoCL compiles otherwise.
std::string device_key(const DeviceDescription &device);

/// Equal keys, equal code.
std::string program_key(const std::string &device_key, const std::string &options, const std::string &source);

/// The same for what a source comes to (needed_source.h), which more sources have in common. Short.
std::string needed_key(const std::string &device_key, const std::string &options, const std::string &meaning);

} // namespace gradus
