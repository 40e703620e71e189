// OpenCL: choosing a device. runtime/device is the only place that includes OpenCL headers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

// cl_context and cl_command_queue, as OpenCL's headers declare them: this header does not ask for those.
struct _cl_context;
struct _cl_command_queue;

namespace gradus {

struct DeviceDescription {
    std::string platform, name, vendor, version, driver;
    std::string platform_version; ///< names the compiler, where there is more than one
    std::string type;             ///< "cpu", "gpu" or "accelerator"
    unsigned compute_units = 0;
    std::uint64_t memory_bytes = 0;     ///< as the implementation reports it, which is not always true
    std::uint64_t local_bytes = 0;      ///< that a work-group shares
    std::uint64_t allocation_bytes = 0; ///< largest single allocation
    bool has_double = false;
    bool is_host = true;       ///< the host's own processor, whose cores trace rays, too
    bool shares_memory = true; ///< with the host: mapping a buffer copies nothing
};

/// Every OpenCL device of every platform, in a stable order; empty where there is none.
std::vector<DeviceDescription> list_devices();

/// The number of the device that a selector (of Device) names among these. Throws Error(ExitCode::device) with the list
/// of what there is.
std::size_t chosen_device(const std::vector<DeviceDescription> &found, const std::string &selector);

/// One OpenCL device with its context and in-order queue.
class Device {
  public:
    /// `selector`: empty (PoCL's CPU device, else the first one), a number from list_devices(), or a part of the
    /// platform's or device's name in any case; one or two digits are a number only. `threads`: how many cores a CPU
    /// device may use, 0 for all; takes effect only for the first device of a process. Throws Error with the list of
    /// what there is.
    explicit Device(const std::string &selector = "", int threads = 0);
    /// A caller's cl_context and cl_command_queue; both are retained. Everything is enqueued on that queue, so it comes
    /// after what the caller enqueued there before. Without CL_QUEUE_PROFILING_ENABLE kernel times are 0. Throws
    /// Error(ExitCode::device) for null, for a queue of another context, or for one that runs out of order.
    Device(_cl_context *context, _cl_command_queue *queue);
    ~Device();
    Device(const Device &) = delete;
    Device &operator=(const Device &) = delete;

    const DeviceDescription &description() const;

    struct Implementation; ///< runtime/device/opencl.h
    Implementation &implementation() { return *implementation_; }

  private:
    std::unique_ptr<Implementation> implementation_;
};

} // namespace gradus
