// Memory of the host that devices copy to and from fastest.
#pragma once

#include "runtime/device/device.h"

#include <cstddef>
#include <memory>

namespace gradus {

/// Page-locked where the OpenCL implementation knows such memory. Throws Error where there is none left.
class HostMemory {
  public:
    HostMemory(Device &device, std::size_t bytes);
    ~HostMemory();
    HostMemory(const HostMemory &) = delete;
    HostMemory &operator=(const HostMemory &) = delete;

    char *data() const { return data_; }
    std::size_t bytes() const { return bytes_; }

  private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
    char *data_;
    std::size_t bytes_;
};

} // namespace gradus
