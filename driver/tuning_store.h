// What `gradus tune` found for each device, kept in a file of the user's cache folder.
#pragma once

#include "planning/tuner.h"
#include "runtime/device/device.h"

#include <optional>
#include <string>

namespace gradus {

/// $XDG_CACHE_HOME/gradus/tuning.json, or the same in ~/.cache; empty where neither variable is set.
std::string tuning_file();

/// What is stored for this device with this driver; nothing where nothing is, or where the file cannot be read or is
/// damaged. `problem`, where given, then says what is wrong with the file.
std::optional<Tuning> stored_tuning(const DeviceDescription &device, std::string *problem = nullptr);

/// Makes the folder of the file. Throws Error(ExitCode::output) where store_tuning() would.
void check_tuning_file();

/// Replaces what is stored for the device. A damaged file is begun anew. Throws Error(ExitCode::output).
void store_tuning(const DeviceDescription &device, const Tuning &tuning);

/// Fills in what the options leave to the device.
void apply_tuning(const std::optional<Tuning> &tuning, RenderOptions &options);

} // namespace gradus
