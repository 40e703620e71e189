// Compiling programs in several processes at once: for implementations that compile one program at a time in each.
#pragma once

#include "runtime/device/compile_job.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

namespace gradus {

/// The program gradus-compile: $GRADUS_COMPILE, else beside the running program, else in ../libexec/gradus, else where
/// the build put it. Empty where there is none.
std::filesystem::path compile_worker_program();

/// Has jobs compiled by up to `processes` workers, the longest source first, and calls `answered` for each in the
/// calling thread, by its number. A worker that dies leaves its job without code. Workers end with this call and with
/// this process; what `answered` throws ends them too. `work_group_size` is that of all launches.
void compile_in_processes(const std::vector<CompileJob> &jobs, std::uint32_t work_group_size, unsigned processes,
                          const std::function<void(std::size_t, const CompileAnswer &)> &answered);

} // namespace gradus
