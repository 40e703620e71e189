// Pictures of the format that GRADUS_FUZZ_PICTURE names: as textures and, by way of images, as environments.
#include "runtime/error.h"
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/environment_file.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_mesh.h"

#include <OpenImageIO/imageio.h>
#include <sanitizer/asan_interface.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <utility>

// OpenImageIO takes 16 MB or more for whatever lines it reads. To note each anew takes the sanitizer most of a run, so
// the last large block is kept for who wants as much: it has its bounds still, but may be used after it was freed.
namespace {

constexpr std::size_t large = std::size_t(1) << 22;
thread_local void *kept = nullptr;
thread_local std::size_t kept_size = 0;
/// Before each block that operator new[] gives is its size; as wide as any alignment.
constexpr std::size_t head = alignof(std::max_align_t);

} // namespace

void *operator new[](std::size_t size) {
    if (kept && kept_size == size)
        return std::exchange(kept, nullptr);
    char *const block = size <= PTRDIFF_MAX ? static_cast<char *>(std::malloc(size + head)) : nullptr;
    if (!block)
        throw std::bad_alloc();
    *reinterpret_cast<std::size_t *>(block) = size;
    ASAN_POISON_MEMORY_REGION(block, head);
    return block + head;
}

void operator delete[](void *pointer) noexcept {
    if (!pointer)
        return;
    char *const block = static_cast<char *>(pointer) - head;
    ASAN_UNPOISON_MEMORY_REGION(block, head);
    const std::size_t size = *reinterpret_cast<std::size_t *>(block);
    if (size >= large && !kept) {
        ASAN_POISON_MEMORY_REGION(block, head);
        kept = pointer;
        kept_size = size;
        return;
    }
    std::free(block);
}

void operator delete[](void *pointer, std::size_t) noexcept { operator delete[](pointer); }

namespace gradus {
namespace {

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
    static const bool set_up = OIIO::attribute("try_all_readers", 0); // a file that its reader refuses is done
    require(set_up);
    const std::string path = folder.write("picture." GRADUS_FUZZ_PICTURE, data, size);
    const auto refused = [](const auto &read) {
        try {
            read();
        } catch (const Error &) {
        } catch (const SceneError &) {
        }
    };
    const auto file = OpenFile::open(path);
    refused([&] { read_as_texture(*file, size); });
    refused([&] { read_as_environment(*file); });
    return 0;
}
