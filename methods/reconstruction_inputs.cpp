#include "methods/reconstruction_inputs.h"

#include "solver/brightness.h"
#include "solver/guide/denoiser.h"
#include "solver/guide/feature_filter.h"

#include <algorithm>
#include <cmath>

namespace gradus {

Buffer uploaded(Device &device, const char *name, std::size_t pixels, const PlaneSource &source) {
    Buffer buffer(device, name, 3 * pixels * sizeof(float));
    const auto mapping = buffer.map(Access::write);
    for (std::uint32_t c = 0; c < 3; ++c)
        source(c, mapping.as<float>() + c * pixels);
    return buffer;
}

Buffer uploaded_features(Device &device, const Image &image) {
    const std::size_t pixels = std::size_t(image.width) * image.height;
    Buffer buffer(device, "guide_features", FeatureFilter::features * pixels * sizeof(float));
    const auto mapping = buffer.map(Access::write);
    std::size_t count = 0;
    for (const Channel &channel : image.channels) {
        const std::string &name = channel.name;
        if (name.starts_with("albedo.") || name.starts_with("normal.") || name == "depth.Z")
            std::copy(channel.values.begin(), channel.values.end(), mapping.as<float>() + pixels * count++);
    }
    return buffer;
}

void check_guide(const RenderOptions &options) {
    if (options.reconstruction == Reconstruction::guided && options.guide == Guide::denoiser)
        Denoiser();
}

std::uint64_t pixels_without_a_color(const Image &image) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < image.channels[0].values.size(); ++i) {
        const auto is_finite = [&](std::size_t c) { return std::isfinite(image.channels[c].values[i]); };
        count += is_finite(0) && is_finite(1) && is_finite(2) ? 0 : 1;
    }
    return count;
}

std::string note_of_colors(const Image &image) {
    return note_of_brightness({image.channels[0].values, image.channels[1].values, image.channels[2].values});
}

} // namespace gradus
