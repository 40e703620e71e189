#include "runtime/error.h"
#include "runtime/io/image_io.h"
#include "tests/fuzz/fuzz_file.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    static const gradus::FuzzFolder folder;
    try {
        const gradus::Image image = gradus::read_image(folder.write("image.exr", data, size));
        for (const gradus::Channel &channel : image.channels)
            if (channel.values.size() != std::size_t(image.width) * image.height)
                std::abort();
    } catch (const gradus::Error &) {
    }
    return 0;
}
