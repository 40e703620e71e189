// Numbers and texts as a row of bytes, for files and sockets of one machine.
#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gradus {

class ByteWriter {
  public:
    void number(std::uint64_t value) { bytes_.append(reinterpret_cast<const char *>(&value), sizeof value); }
    void seconds(double value) { bytes_.append(reinterpret_cast<const char *>(&value), sizeof value); }
    void text(std::string_view value) {
        number(value.size());
        bytes_.append(value);
    }
    const std::string &bytes() const { return bytes_; }

  private:
    std::string bytes_;
};

/// Throws std::runtime_error where the bytes end too early.
class ByteReader {
  public:
    explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
    std::uint64_t number() { return fixed<std::uint64_t>(); }
    double seconds() { return fixed<double>(); }
    std::string_view text() { return take(number()); }
    std::string_view rest() const { return rest_; }

  private:
    template <class Value>
    Value fixed() {
        Value value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string_view take(std::uint64_t count) {
        if (count > rest_.size())
            throw std::runtime_error("a record is shorter than it says");
        const std::string_view taken = rest_.substr(0, count);
        rest_.remove_prefix(count);
        return taken;
    }

    std::string_view rest_;
};

} // namespace gradus
