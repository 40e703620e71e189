#include "runtime/io/environment_file.h"

#include "runtime/error.h"
#include "runtime/io/image_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gradus {
namespace {

/// Bad texels of a plane, mended.
struct Mended {
    std::uint64_t negative = 0, not_numbers = 0, infinite = 0;
};

/// Above this values count as infinite: what the whole sphere adds up to must fit into single precision.
constexpr float most_radiance = 1e30f;

float largest_finite(const std::vector<float> &values) {
    float largest = 0;
    for (const float value : values)
        if (value > largest && value <= most_radiance)
            largest = value;
    return largest;
}

void mend(std::vector<float> &values, float largest, Mended &mended) {
    for (float &value : values) {
        if (value >= 0 && value <= largest)
            continue;
        if (std::isnan(value))
            ++mended.not_numbers;
        else
            ++(value < 0 ? mended.negative : mended.infinite);
        value = value > 0 ? largest : 0;
    }
}

} // namespace

std::shared_ptr<const EnvironmentMap> read_environment(const OpenFile &file, std::uint64_t limits,
                                                       const Location &location, Diagnostics &diagnostics) {
    const std::string path = file.name().string();
    Image image;
    try {
        image = read_image(file, limits);
    } catch (const Error &error) {
        throw SceneError(location, error.what());
    }
    if (std::uint64_t(image.width) * image.height > most_environment_texels)
        throw SceneError(location, fmt::format("the environment map {} has {} x {} texels; {} million are possible",
                                               path, image.width, image.height, most_environment_texels >> 20));
    std::vector<Channel *> planes;
    for (const char *name : {"R", "G", "B"})
        for (Channel &channel : image.channels)
            if (channel.name == name && planes.size() < 3)
                planes.push_back(&channel);
    if (planes.size() != 3)
        planes = {&image.channels.front()};
    float largest = 0;
    for (const Channel *plane : planes)
        largest = std::max(largest, largest_finite(plane->values));
    Mended mended;
    for (Channel *plane : planes)
        mend(plane->values, largest, mended);
    const auto warn = [&](std::uint64_t count, const std::string &what) {
        if (count > 0)
            diagnostics.warn(location, fmt::format("the environment map {} has {} {}", path, count, what));
    };
    warn(mended.negative, "negative values, which count as 0");
    warn(mended.not_numbers, "values that are not numbers, which count as 0");
    warn(mended.infinite, fmt::format("infinite values, which count as its largest one, {:g}", largest));
    const auto plane = [&](std::size_t c) { return std::span(planes[std::min(c, planes.size() - 1)]->values); };
    return std::make_shared<const EnvironmentMap>(
        make_environment_map(image.width, image.height, plane(0), plane(1), plane(2)));
}

} // namespace gradus
