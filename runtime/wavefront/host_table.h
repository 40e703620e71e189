// A table of the device on the host, in whichever precision its kernels were compiled.
#pragma once

#include "runtime/device/buffer.h"
#include "runtime/device/precision.h"

#include <cstdint>
#include <cstring>
#include <vector>

namespace gradus {

class HostTable {
  public:
    /// Waits for the device and copies all columns of a table of `rows` rows.
    HostTable(const Buffer &buffer, std::size_t rows, Precision precision)
        : rows_(rows), bytes_(buffer.bytes()), size_(real_bytes(precision)) {
        buffer.read(bytes_.data(), bytes_.size());
    }
    double real(int column, std::size_t row) const {
        const char *place = &bytes_[(std::size_t(column) * rows_ + row) * size_];
        return size_ == 8 ? load<double>(place) : load<float>(place);
    }
    std::uint32_t uint(int column, std::size_t row) const {
        return load<std::uint32_t>(&bytes_[(std::size_t(column) * rows_ + row) * size_]);
    }

  private:
    template <class T>
    static T load(const char *place) {
        T value;
        std::memcpy(&value, place, sizeof value);
        return value;
    }
    std::size_t rows_;
    std::vector<char> bytes_;
    std::size_t size_;
};

} // namespace gradus
