#include "runtime/io/image_io.h"

#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/io/exr_file.h"
#include "runtime/io/image_checks.h"
#include "runtime/io/picture_library.h"

#include <fmt/format.h>

#include <optional>
#include <vector>

namespace gradus {
namespace {

void check_channels(const Image &image, const std::string &path) {
    if (image.width == 0 || image.height == 0 || image.channels.empty())
        fail_to_write(path, "the image is empty");
    for (const Channel &channel : image.channels)
        if (channel.values.size() != std::size_t(image.width) * image.height)
            fail_to_write(path, fmt::format("channel '{}' has {} values, not {} x {}", channel.name,
                                            channel.values.size(), image.width, image.height));
}

} // namespace

Image read_image(const std::string &path, std::uint64_t limits) {
    const auto file = OpenFile::open(path);
    if (!file)
        throw Error(ExitCode::image, fmt::format("cannot read the image '{}'{}", path, why_not(path)));
    return read_image(*file, limits);
}

Image read_image(const OpenFile &file, std::uint64_t limits, WholeNumbers are) {
    if (const std::optional<ExrSize> declared = exr_size(file.library_name()))
        return read_exr(file, *declared, limits);
    return picture_library().read_image(file, limits, are);
}

void write_image(const Image &image, const std::string &path) {
    check_channels(image, path);
    const std::vector<unsigned char> bytes = encode_exr(image, path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

void write_png(const Image &image, const std::string &path) {
    check_channels(image, path);
    const std::vector<unsigned char> bytes = picture_library().png_of(image, path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

} // namespace gradus
