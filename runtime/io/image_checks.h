// What is checked before the pixels of an image file are read, and how errors name it.
#pragma once

#include "runtime/io/open_file.h"

#include <cstdint>
#include <string>

namespace gradus {

/// Bytes of pixels that may be read of a file, as read_image() says it: a few kilobytes can declare any number.
std::uint64_t most_pixel_bytes(const OpenFile &file, std::uint64_t limits);

/// A library's words about a file, which call it by its name.
std::string named_in(std::string message, const OpenFile &file);

/// Throws Error(ExitCode::image).
[[noreturn]] void fail_to_read(const OpenFile &file, const std::string &reason);

/// What may be read of a file.
class PixelLimit {
  public:
    PixelLimit(const OpenFile &file, std::uint64_t limits);

    /// Before so many bytes of pixels are read.
    void check_bytes(std::uint64_t bytes) const;
    /// Before a part's pixels are read. Throws where the parts so far have too many channels or pixels.
    void count(std::uint64_t width, std::uint64_t height, std::uint64_t channels);

  private:
    const OpenFile &file_;
    std::uint64_t most_channels_, most_bytes_, channels_ = 0, bytes_ = 0;
};

} // namespace gradus
