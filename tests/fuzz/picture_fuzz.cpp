// Pictures of the format that GRADUS_FUZZ_PICTURE names: as images, as textures and as environments.
#include "runtime/error.h"
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/environment_file.h"
#include "runtime/io/image_io.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_mesh.h"

#include <cmath>

namespace gradus {
namespace {

void read_as_image(const std::string &path) {
    const Image image = read_image(path);
    for (const Channel &channel : image.channels)
        require(channel.values.size() == std::size_t(image.width) * image.height);
}

/// `kind` chooses what a scene file asks of it.
void read_as_texture(const OpenFile &file, std::size_t kind) {
    const char *const channels[] = {"", "r", "a"};
    const Bitmap bitmap = read_bitmap(file, {kind % 2 == 0, channels[kind / 2 % 3]}).bitmap;
    require(bitmap.words.size() ==
            Bitmap::words_for(std::uint64_t(bitmap.width) * bitmap.height, bitmap.format, bitmap.is_color));
    for (int channel = 0; channel < (bitmap.is_color ? 3 : 1); ++channel)
        require(std::isfinite(bitmap.channel(bitmap.width - 1, bitmap.height - 1, channel)));
}

void read_as_environment(const OpenFile &file) {
    Diagnostics diagnostics(false);
    const auto map = read_environment(file, 1, {}, diagnostics);
    require(map->integral.r >= 0 && std::isfinite(map->integral.g) && std::isfinite(map->integral.b));
}

} // namespace
} // namespace gradus

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    using namespace gradus;
    static const FuzzFolder folder;
    const std::string path = folder.write("picture." GRADUS_FUZZ_PICTURE, data, size);
    const auto refused = [](const auto &read) {
        try {
            read();
        } catch (const Error &) {
        } catch (const SceneError &) {
        }
    };
    const auto file = OpenFile::open(path);
    refused([&] { read_as_image(path); });
    refused([&] { read_as_texture(*file, size); });
    refused([&] { read_as_environment(*file); });
    return 0;
}
