// Kernels: compiled for the traits that they declare, launched by name, their arguments set by name.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/device.h"
#include "runtime/device/precision.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gradus {

/// Values of the names that kernels declare in their "//! traits:" lines.
using TraitValues = std::map<std::string, int>;

/// One kernel of a program: which file, which entry, and what it is compiled for.
struct KernelRequest {
    std::string name;                               ///< its row in the profile: "shade diffuse"
    std::string file;                               ///< "kernels/stages/shade.cl"
    std::string entry;                              ///< "shade"
    std::map<std::string, std::string> definitions; ///< more macros, such as BSDF=diffuse
    bool strict = false;                            ///< never relaxed: what counts on rounding or on NaN
};

/// A compiled kernel with its arguments.
class Kernel {
  public:
    /// False for one that was never built: what a scene does not need.
    bool valid() const { return handle_ != nullptr; }
    const std::string &name() const;

    /// The names of its arguments.
    std::vector<std::string> argument_names() const;

    /// Gives every argument whose name is the buffer's name that buffer. Arguments of other names stay as they are.
    void bind(const Buffer &buffer) { bind(buffer.name(), buffer); }
    void bind(const std::string &argument, const Buffer &buffer);
    /// Sets an argument by value; one that the kernel does not have is left out in silence, so that a stage need not
    /// know which variant it launches.
    void set(const std::string &argument, std::uint32_t value);
    void set_real(const std::string &argument, double value);

    /// Enqueues `items` work-items or a few more, numbered by work_item() in the kernel. Every argument must have been
    /// set: throws std::logic_error that names it.
    void launch(std::size_t items);
    /// Enqueues `lines` times `items` work-items: get_group_id(1) is the line, and each has `items` or, for groups to
    /// be whole, a few more.
    void launch(std::size_t items, std::size_t lines);
    /// Enqueues `items` work-items, numbered as by launch(items), for each of `planes`: get_global_id(2) is the plane.
    void launch_planes(std::size_t items, std::size_t planes);

    /// What all launches so far took on the device. Waits for them, where the queue times them; else seconds are 0.
    struct Usage {
        double seconds = 0;
        std::uint64_t launches = 0, items = 0;
    };
    Usage usage() const;
    void reset_usage();

  private:
    friend class KernelLibrary;
    struct Handle;
    std::shared_ptr<Handle> handle_;
};

constexpr std::uint32_t default_work_group_size = 64;

/// Builds kernels and keeps them; equal requests share a program.
class KernelLibrary {
  public:
    /// `work_group_size` 0: default_work_group_size, the only one that the solver's kernels take. Throws
    /// Error(ExitCode::device) for double on a device that has none.
    KernelLibrary(Device &device, TraitValues traits, Precision precision = Precision::single,
                  std::uint32_t work_group_size = 0);

    /// Called after each kernel was built: its name, how many are built, of how many, and the seconds that compiling
    /// its program took: 0 where that was not compiled for it. What it throws ends the build.
    using Progress = std::function<void(const std::string &, std::size_t, std::size_t, double)>;
    /// Builds several kernels, several at a time, or takes them from the folder of programs (cache_folder.h). Where
    /// `dump_folder` is not empty, the final source of each goes there. Throws Error with the compiler's log.
    std::vector<Kernel> build(const std::vector<KernelRequest> &requests, const Progress &progress = {},
                              const std::string &dump_folder = "");

    std::uint32_t work_group_size() const { return work_group_size_; }

  private:
    Device &device_;
    TraitValues traits_;
    Precision precision_;
    std::uint32_t work_group_size_;
};

/// While somebody holds what this returns, processes that compile kernels for the device wait for more after each
/// build(). Else they end, and the next build() starts others.
std::shared_ptr<void> keep_compilers(Device &device);

/// Waits until the device has done all that was asked of it.
void finish(Device &device);

/// The most bytes that were allocated on the device at one time.
std::uint64_t peak_device_bytes(Device &device);

} // namespace gradus
