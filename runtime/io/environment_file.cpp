#include "runtime/io/environment_file.h"

#include "runtime/error.h"
#include "runtime/io/text.h"

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

/// The channel of that name, in lower case; nullptr: there is none.
Channel *channel_named(Image &image, const std::string &name) {
    const auto found = std::find_if(image.channels.begin(), image.channels.end(),
                                    [&](const Channel &channel) { return lower_case(channel.name) == name; });
    return found == image.channels.end() ? nullptr : &*found;
}

/// Channels that make one picture: three, or one for gray.
using Planes = std::vector<Channel *>;

/// The pictures that an image may stand for: the file's own R, G and B, or those of its layers ("Layer.R"), or else a Y
/// of either, or its only channel. A Y beside X and Z is no gray.
std::vector<Planes> pictures_in(Image &image) {
    std::vector<std::string> layers = {""};
    for (const Channel &channel : image.channels)
        if (std::string layer = lower_case(channel.name.substr(0, channel.name.rfind('.') + 1)); layer != layers.back())
            layers.push_back(std::move(layer));
    std::vector<Planes> colors, grays;
    for (const std::string &layer : layers) {
        const Planes color = {channel_named(image, layer + "r"), channel_named(image, layer + "g"),
                              channel_named(image, layer + "b")};
        if (std::ranges::count(color, nullptr) == 0)
            colors.push_back(color);
        Channel *const luminance = channel_named(image, layer + "y");
        if (luminance && !(channel_named(image, layer + "x") && channel_named(image, layer + "z")))
            grays.push_back({luminance});
        if (layer.empty() && !colors.empty())
            return colors;
    }
    if (!colors.empty())
        return colors;
    return grays.empty() && image.channels.size() == 1 ? std::vector<Planes>{{&image.channels.front()}} : grays;
}

} // namespace

std::shared_ptr<const EnvironmentMap> read_environment(const OpenFile &file, std::uint64_t limits,
                                                       const Location &location, Diagnostics &diagnostics,
                                                       WholeNumbers are) {
    const std::string path = file.name().string();
    Image image;
    try {
        image = read_image(file, limits, are);
    } catch (const Error &error) {
        throw SceneError(location, error.what());
    }
    if (std::uint64_t(image.width) * image.height > most_environment_texels)
        throw SceneError(location, fmt::format("the environment map {} has {} x {} texels; {} million are possible",
                                               path, image.width, image.height, most_environment_texels >> 20));
    if (image.height > most_environment_rows(image.width))
        throw SceneError(location, fmt::format("the environment map {} has {} x {} texels; so narrow a one may have {} "
                                               "rows",
                                               path, image.width, image.height, most_environment_rows(image.width)));
    const std::vector<Planes> pictures = pictures_in(image);
    if (pictures.empty())
        throw SceneError(location, fmt::format("of the {} channels of the environment map {} none are R, G, B or Y; "
                                               "X, Y and Z are not read: save it as R, G and B",
                                               image.channels.size(), path));
    const Planes &planes = pictures.front();
    if (pictures.size() > 1)
        diagnostics.warn(location, fmt::format("the environment map {} has {} layers that could be meant; it is that "
                                               "of the channel {}",
                                               path, pictures.size(), planes.front()->name));
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
