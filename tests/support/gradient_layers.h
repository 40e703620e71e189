// The layers of a gradient-domain render, as tests read them.
#pragma once

#include "tests/support/render.h"

namespace gradus::testing {

inline const char *const colors[] = {"R", "G", "B"};

/// An image of R, G and B from a function of channel and pixel.
template <class Value>
Image image_of(std::uint32_t width, std::uint32_t height, Value value) {
    Image image;
    image.width = width;
    image.height = height;
    for (int c = 0; c < 3; ++c) {
        Channel channel{colors[c], std::vector<float>(std::size_t(width) * height)};
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                channel.values[std::size_t(y) * width + x] = static_cast<float>(value(c, x, y));
        image.channels.push_back(std::move(channel));
    }
    return image;
}

/// All red values, all green ones, all blue ones.
inline std::vector<double> values_of(const Image &image) {
    std::vector<double> values;
    for (const char *color : colors) {
        const std::vector<float> &channel = image.find(color)->values;
        values.insert(values.end(), channel.begin(), channel.end());
    }
    return values;
}

inline double layer(const Image &image, const std::string &name, int c, std::uint32_t x, std::uint32_t y) {
    return pixel(image, x, y, name.empty() ? colors[c] : name + "." + colors[c]);
}

/// One layer, for many reads: its channels are found once.
class Layer {
  public:
    Layer(const Image &image, const std::string &name) : width_(image.width) {
        for (int c = 0; c < 3; ++c)
            values_[c] = &image.find(name.empty() ? colors[c] : name + "." + colors[c])->values;
    }
    double operator()(int c, std::uint32_t x, std::uint32_t y) const {
        return values_[c]->at(std::size_t(y) * width_ + x);
    }

  private:
    std::uint32_t width_;
    const std::vector<float> *values_[3];
};

/// The primal image and what the camera sees of lights: what the path tracer estimates.
inline Image whole(const Image &image) {
    const Layer primal(image, "primal"), direct(image, "direct");
    return image_of(image.width, image.height,
                    [&](int c, std::uint32_t x, std::uint32_t y) { return primal(c, x, y) + direct(c, x, y); });
}

/// Differences to the right or downwards of one layer; 0 at the border.
inline Image differences(const Image &image, const std::string &name, bool right) {
    const Layer of(image, name);
    return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
        const std::uint32_t to_x = right ? x + 1 : x, to_y = right ? y : y + 1;
        return to_x < image.width && to_y < image.height ? of(c, to_x, to_y) - of(c, x, y) : 0.0;
    });
}

/// dx or dy, with the differences of what the camera sees of lights: an estimate of the differences of whole().
inline Image whole_differences(const Image &image, bool right) {
    const Image differences_seen = differences(image, "direct", right);
    const Layer of(image, right ? "dx" : "dy"), seen(differences_seen, "");
    return image_of(image.width, image.height,
                    [&](int c, std::uint32_t x, std::uint32_t y) { return of(c, x, y) + seen(c, x, y); });
}

} // namespace gradus::testing
