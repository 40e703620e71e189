#include "runtime/io/image_checks.h"

#include "runtime/error.h"

#include <fmt/format.h>

namespace gradus {

std::uint64_t most_pixel_bytes(const OpenFile &file, std::uint64_t limits) {
    constexpr std::uint64_t always = 256u << 20, unfolding = 64;
    return (always + file.bytes() * unfolding) * limits;
}

std::string named_in(std::string message, const OpenFile &file) {
    const std::string &alias = file.library_name(), name = file.name().string();
    for (std::size_t at = 0; alias != name && (at = message.find(alias, at)) != std::string::npos; at += name.size())
        message.replace(at, alias.size(), name);
    return message;
}

void fail_to_read(const OpenFile &file, const std::string &reason) {
    throw Error(ExitCode::image, fmt::format("cannot read the image '{}': {}", file.name().string(), reason));
}

void fail_to_write(const std::string &path, const std::string &reason) {
    if (reason.empty() || reason.find("bad_alloc") != std::string::npos)
        throw Error(ExitCode::device, fmt::format("cannot write '{}': there is not enough memory to encode it; try a "
                                                  "smaller --size, or a --crop",
                                                  path));
    throw Error(ExitCode::output, fmt::format("cannot write '{}': {}", path, reason));
}

PixelLimit::PixelLimit(const OpenFile &file, std::uint64_t limits)
    : file_(file), most_channels_(1024 * limits), most_bytes_(most_pixel_bytes(file, limits)) {}

void PixelLimit::check_bytes(std::uint64_t bytes) const {
    if (bytes > most_bytes_)
        fail_to_read(file_, fmt::format("its pixels would take {} MiB, far more than a file of its size holds; "
                                        "--limits 10 allows ten times the {} MiB that are read",
                                        bytes >> 20, most_bytes_ >> 20));
}

void PixelLimit::begin_part(int number, std::int64_t width, std::int64_t height, std::uint64_t channels, Image &image) {
    if (width <= 0 || height <= 0 || channels == 0)
        fail_to_read(file_, "it is not a plane of pixels");
    channels_ += channels;
    if (channels_ > most_channels_)
        fail_to_read(file_,
                     fmt::format("it has more than {} channels; --limits 10 allows ten times as many", most_channels_));
    // At most 2^31 times 2^31 times 1024 * 4: in floating point, against overflow.
    const double bytes = double(width) * double(height) * double(channels) * sizeof(float);
    check_bytes(bytes < 1e18 ? std::uint64_t(bytes) + bytes_ : ~std::uint64_t(0));
    bytes_ += std::uint64_t(bytes);
    if (number == 0) {
        image.width = static_cast<std::uint32_t>(width);
        image.height = static_cast<std::uint32_t>(height);
    } else if (image.width != width || image.height != height) {
        fail_to_read(file_, fmt::format("part {} is {}x{}, the first one {}x{}", number, width, height, image.width,
                                        image.height));
    }
}

} // namespace gradus
