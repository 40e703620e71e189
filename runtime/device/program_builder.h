// Programs for a device: from this process, from the store of programs, or compiled.
#pragma once

#include "runtime/device/program_code.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gradus {

/// Called as each program is ready, one call at a time, with its number and the seconds that it took to
/// compile: 0 where it was not.
using ProgramReady = std::function<void(std::size_t, double)>;

/// The processes that compile for the device. They end when nobody has them any more.
std::shared_ptr<CompileWorkers> compile_workers(Device::Implementation &device);

/// PoCL unpacks the code of a program into the private folder, and opens a kernel's when it is first launched. Where
/// that folder was deleted meanwhile, its code is unpacked once more: PoCL ends the process where it misses it.
void restore_code(Device::Implementation &device);

/// One program for each source, equal ones shared. What is compiled goes into the device's store. Several threads may
/// ask at once; none compiles what another one does. Throws Error with the compiler's log.
std::vector<std::shared_ptr<const BuiltProgram>> obtain_programs(Device::Implementation &device,
                                                                 const std::vector<ProgramSource> &sources,
                                                                 std::uint32_t work_group_size,
                                                                 const ProgramReady &ready);

} // namespace gradus
