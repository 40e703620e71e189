#include "runtime/film/tonemap.h"

#include "runtime/error.h"

#include <cmath>

namespace gradus {

float srgb_encode(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1.0f / 2.4f) - 0.055f;
}

float srgb_decode(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

std::vector<std::uint8_t> tonemap(const Image &image) {
    std::vector<std::uint8_t> pixels(std::size_t(image.width) * image.height * 3);
    tonemap(image, 0, image.height, pixels.data());
    return pixels;
}

void tonemap(const Image &image, std::size_t first_row, std::size_t end_row, std::uint8_t *pixels) {
    const char *names[3] = {"R", "G", "B"};
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel *channel = image.find(names[c]);
        if (!channel)
            throw Error(ExitCode::image, std::string("a tone-mapped image needs the channel '") + names[c] + "'");
        const float *values = channel->values.data() + first_row * image.width;
        for (std::size_t i = 0; i < (end_row - first_row) * image.width; ++i) {
            // Written so that NaN fails the first comparison.
            const float clamped = values[i] > 0.0f ? (values[i] < 1.0f ? values[i] : 1.0f) : 0.0f;
            pixels[i * 3 + c] = static_cast<std::uint8_t>(std::lround(255.0f * srgb_encode(clamped)));
        }
    }
}

} // namespace gradus
