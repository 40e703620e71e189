// The OpenCL side of Device, for the files of runtime/device only.
#pragma once

#include "runtime/device/device.h"
#include "runtime/device/launch_observer.h"
#include "runtime/device/program_store.h"
#include "runtime/error.h"

#define CL_TARGET_OPENCL_VERSION 120
#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#include <CL/opencl.hpp>

#include <atomic>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace gradus {

struct BuiltProgram;
class CompileWorkers;

/// Programs that were built for a device in this process, by options and a hash of the source.
struct BuiltPrograms {
    std::mutex mutex;
    std::map<std::string, std::shared_future<std::shared_ptr<const BuiltProgram>>> programs;
};

struct Device::Implementation {
    DeviceDescription description;
    cl::Device device;
    cl::Context context;
    cl::CommandQueue queue;
    bool profiles = true;      ///< the queue times what runs on it
    unsigned host_threads = 1; ///< that compile programs, and clear the host's memory
    std::uint64_t allocated_bytes = 0, peak_bytes = 0;
    BuiltPrograms built;
    std::weak_ptr<CompileWorkers> compile_workers; ///< while somebody keeps them; built.mutex is for them too
    ProgramStore store;                            ///< what other processes built
    std::atomic<std::size_t> compiled{0};          ///< programs that were not taken from there
    LaunchObserver observer;                       ///< empty: none
    std::mutex restoring;
    unsigned renewals = 0;             ///< of the private folder, after which code was unpacked there again
    std::vector<cl::Program> restored; ///< for that
    /// A compiler's exception flew through OpenCL (compiler_call()): nothing that the device has is released any more.
    std::atomic<bool> is_stuck{false};

    ~Implementation() { finish_quietly(); } // threads of the implementation must not outlive the program's memory
    /// Waits for all that is queued, where nobody could do anything about an error.
    void finish_quietly() noexcept {
        if (queue() && !is_stuck)
            ::clFinish(queue());
    }
};

struct FoundDevice {
    cl::Device device;
    DeviceDescription description;
};

/// How many threads run kernels: the second name is that of PoCL 4 and later, which is first asked for there.
constexpr const char *pocl_thread_variables[] = {"POCL_MAX_PTHREAD_COUNT", "POCL_CPU_MAX_CU_COUNT"};

/// Every device of every platform, as list_devices() has them. `threads` is Device's. Several threads may ask at once.
std::vector<FoundDevice> find_devices(int threads = 0);

bool is_pocl_cpu(const DeviceDescription &device);
/// Of version 3.1, which is Debian 12's, and whose insides pocl_compiler.h and others know.
bool is_pocl_3_1_cpu(const DeviceDescription &device);
/// Of Ubuntu 24.04 and Debian 13, which vectorise nothing by themselves.
bool is_pocl_5_or_6_cpu(const DeviceDescription &device);
bool is_oclgrind(const DeviceDescription &device);

/// Runs a function and turns an OpenCL error into an Error that says what was being done.
template <class Function>
auto opencl_call(const std::string &doing, Function function) -> decltype(function());

[[noreturn]] void throw_opencl_error(const std::string &doing, const cl::Error &error);

template <class Function>
auto opencl_call(const std::string &doing, Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const cl::Error &error) {
        throw_opencl_error(doing, error);
    }
}

/// The same for calls that may compile. An exception that is none of OpenCL's flies through PoCL 3.1, as LLVM's
/// std::bad_alloc does, and a lock is left behind that whoever releases a program waits for: so none is from then on.
template <class Function>
auto compiler_call(Device::Implementation &device, const std::string &doing, Function function)
    -> decltype(function()) {
    try {
        return opencl_call(doing, function);
    } catch (const Error &) {
        throw;
    } catch (...) {
        device.is_stuck = true;
        throw;
    }
}

} // namespace gradus
