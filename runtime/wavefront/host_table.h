// A table of the device on the host, in whichever precision its kernels were compiled.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/precision.h"

#include <cstdint>
#include <cstring>

namespace gradus {

/// Where host and device share memory, nothing is copied.
class HostTable {
  public:
    /// Waits for the device. The table has `rows` rows; no kernel may write to it meanwhile, and `buffer` must outlive
    /// this.
    HostTable(const Buffer &buffer, std::size_t rows, Precision precision)
        : rows_(rows), mapping_(buffer.map(Access::read)), size_(real_bytes(precision)) {}
    double real(int column, std::size_t row) const {
        const char *place = place_of(column, row);
        return size_ == 8 ? load<double>(place) : load<float>(place);
    }
    std::uint32_t uint(int column, std::size_t row) const { return load<std::uint32_t>(place_of(column, row)); }

  private:
    const char *place_of(int column, std::size_t row) const {
        return mapping_.as<const char>() + (std::size_t(column) * rows_ + row) * size_;
    }
    template <class T>
    static T load(const char *place) {
        T value;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    std::size_t rows_;
    Buffer::Mapping mapping_;
    std::size_t size_;
};

} // namespace gradus
