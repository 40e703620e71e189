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
    /// to[i] += that of row first + i, for rows [first, end).
    void add_reals(int column, std::size_t first, std::size_t end, double *to) const {
        if (size_ == 8)
            add<double>(place_of(column, first), end - first, to);
        else
            add<float>(place_of(column, first), end - first, to);
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
    template <class T>
    static void add(const char *from, std::size_t count, double *to) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] += load<T>(from + i * sizeof(T));
    }
    std::size_t rows_;
    Buffer::Mapping mapping_;
    std::size_t size_;
};

} // namespace gradus
