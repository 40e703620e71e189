// What is checked before the pixels of an image file are read, and how errors name it.
#pragma once

#include "runtime/film/image.h"
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

/// Throws Error(ExitCode::output), or Error(ExitCode::device) where `reason` is a lack of memory: of that libraries
/// have no words, or std::bad_alloc's.
[[noreturn]] void fail_to_write(const std::string &path, const std::string &reason);

/// What may be read of a file.
class PixelLimit {
  public:
    PixelLimit(const OpenFile &file, std::uint64_t limits);

    /// Before so many bytes of pixels are read.
    void check_bytes(std::uint64_t bytes) const;
    /// Before the pixels of part `number` are read. Gives the image the first one's size, and throws where another's
    /// differs, where it has no pixels, or the parts so far have too many of them or of channels.
    void begin_part(int number, std::int64_t width, std::int64_t height, std::uint64_t channels, Image &image);

  private:
    const OpenFile &file_;
    std::uint64_t most_channels_, most_bytes_, channels_ = 0, bytes_ = 0;
};

} // namespace gradus
