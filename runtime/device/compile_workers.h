// Compiling programs in several processes at once: for implementations that compile one program at a time in each.
#pragma once

#include "runtime/device/compile_job.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace gradus {

class CompileWorker;

/// The program gradus-compile: $GRADUS_COMPILE, else beside the running program, else in ../libexec/gradus, else where
/// the build put it. Empty where there is none.
std::filesystem::path compile_worker_program();

/// Seconds that a worker may take for one program: $GRADUS_COMPILE_LIMIT, else 120. None of ours takes five.
double compile_limit();

/// Processes that compile for one device. A new one takes a third of a second before it compiles anything, to read the
/// library of built-in functions; so those that have nothing left to do stay, until this object goes.
class CompileWorkers {
  public:
    CompileWorkers();
    ~CompileWorkers();
    CompileWorkers(const CompileWorkers &) = delete;
    CompileWorkers &operator=(const CompileWorkers &) = delete;

    /// Has jobs compiled by up to `processes` workers, the longest source first, and calls `answered` for each in the
    /// calling thread, by its number. A worker that dies leaves its job without code, and so does one that takes longer
    /// than compile_limit(), which is ended. Workers end with this process too; what `answered` throws ends those that
    /// are busy. `work_group_size` is that of all launches. Several threads may call at once; each has its workers.
    void compile(const std::vector<CompileJob> &jobs, std::uint32_t work_group_size, unsigned processes,
                 const std::function<void(std::size_t, const CompileAnswer &)> &answered);

  private:
    std::unique_ptr<CompileWorker> idle_worker(std::uint32_t work_group_size);

    std::mutex mutex_;
    std::vector<std::unique_ptr<CompileWorker>> idle_;
};

} // namespace gradus
