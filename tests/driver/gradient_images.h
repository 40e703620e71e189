// Images for the tests of `gradus solve`, in a folder that is removed at the end.
#pragma once

#include "runtime/film/image.h"
#include "runtime/io/image_io.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// A channel that is `first` at the top left and grows by 1 from pixel to pixel.
inline Channel counting(const std::string &name, std::uint32_t width, std::uint32_t height, float first) {
    Channel channel{name, std::vector<float>(std::size_t(width) * height)};
    for (float &value : channel.values)
        value = first++;
    return channel;
}

/// An image of such channels.
inline Image counting_image(std::uint32_t width, std::uint32_t height,
                            const std::vector<std::pair<std::string, float>> &channels) {
    Image image;
    image.width = width;
    image.height = height;
    for (const auto &[name, first] : channels)
        image.channels.push_back(counting(name, width, height, first));
    return image;
}

/// Channels R, G, B of a layer (or of none), which begin with `first`, `first` + 10 and `first` + 20.
inline std::vector<std::pair<std::string, float>> colours(const std::string &layer, float first) {
    const std::string lead = layer.empty() ? "" : layer + ".";
    return {{lead + "R", first}, {lead + "G", first + 10}, {lead + "B", first + 20}};
}

/// The channels of several layers.
inline std::vector<std::pair<std::string, float>>
layers(const std::vector<std::pair<std::string, float>> &names_and_firsts) {
    std::vector<std::pair<std::string, float>> channels;
    for (const auto &[name, first] : names_and_firsts)
        for (const auto &channel : colours(name, first))
            channels.push_back(channel);
    return channels;
}

class GradientImagesTest : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (std::filesystem::temp_directory_path() / "gradus-gradients-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { std::filesystem::remove_all(folder); }

    std::string at(const std::string &name) const { return (folder / name).string(); }
    /// Writes an image and returns its path.
    std::string write(const std::string &name, const Image &image) const {
        write_image(image, at(name));
        return at(name);
    }
    /// 3 x 2 pixels of R, G, B.
    std::string write_colours(const std::string &name, float first) const {
        return write(name, counting_image(3, 2, colours("", first)));
    }
    /// 3 x 2 pixels of the layers primal, dx and dy, which begin with 100, 200 and 300.
    std::string write_layers(const std::string &name) const {
        return write(name, counting_image(3, 2, layers({{"primal", 100}, {"dx", 200}, {"dy", 300}})));
    }
    std::string write_text(const std::string &name, const std::string &text) const {
        std::ofstream(folder / name, std::ios::binary) << text;
        return at(name);
    }

    std::filesystem::path folder;
};

} // namespace gradus
