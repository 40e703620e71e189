#include "runtime/io/image_io.h"

#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/io/picture_library.h"

#include <fmt/format.h>

#include <vector>

namespace gradus {

Image read_image(const std::string &path, std::uint64_t limits) {
    const auto file = OpenFile::open(path);
    if (!file)
        throw Error(ExitCode::image, fmt::format("cannot read the image '{}': there is no such file, or it is not for "
                                                 "reading",
                                                 path));
    return read_image(*file, limits);
}

Image read_image(const OpenFile &file, std::uint64_t limits) { return picture_library().read_image(file, limits); }

void write_image(const Image &image, const std::string &path) {
    const std::vector<unsigned char> bytes = picture_library().exr_of(image, path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

void write_png(const Image &image, const std::string &path) {
    const std::vector<unsigned char> bytes = picture_library().png_of(image, path);
    write_file_atomically(path, bytes.data(), bytes.size());
}

} // namespace gradus
