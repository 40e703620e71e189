#include "runtime/device/host_memory.h"

#include "runtime/device/opencl.h"

#include <fmt/format.h>

namespace gradus {

struct HostMemory::Handle {
    Device::Implementation &device;
    cl::Buffer memory;
};

HostMemory::HostMemory(Device &device, std::size_t bytes) : bytes_(bytes) {
    Device::Implementation &d = device.implementation();
    // A buffer that stays mapped: OpenCL names no other way to such memory.
    data_ = static_cast<char *>(opencl_call(fmt::format("allocating {} MB of the host", bytes >> 20), [&] {
        handle_ = std::make_unique<Handle>(d, cl::Buffer(d.context, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes));
        return d.queue.enqueueMapBuffer(handle_->memory, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
    }));
}

HostMemory::~HostMemory() {
    handle_->device.finish_quietly(); // copies may be on their way
    try {
        handle_->device.queue.enqueueUnmapMemObject(handle_->memory, data_);
    } catch (const cl::Error &) {
        // Nothing can be done here; the next call on the queue reports the error.
    }
}

} // namespace gradus
