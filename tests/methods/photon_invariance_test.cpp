// What must not change the images of photon mapping.
#include "tests/methods/photon_case.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/test_name.h"

#include <optional>

namespace gradus::testing {
namespace {

class PhotonInvariance : public ::testing::TestWithParam<const char *> {
  protected:
    static RenderOptions options() {
        RenderOptions options;
        options.photons = 6000;
        return options;
    }
    static Scene scene() {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", 61, 47);
        scene.settings.samples_per_pixel = 3;
        return scene;
    }
};

/// Compares pixels that are like their neighbours: those do not depend on where in the pixel samples fall.
void expect_alike_where_uniform(const Image &image, const Image &other, const char *channel) {
    const std::vector<float> &values = image.find(channel)->values, &others = other.find(channel)->values;
    std::size_t uniform = 0, different = 0;
    for (std::uint32_t y = 1; y + 1 < image.height; ++y)
        for (std::uint32_t x = 1; x + 1 < image.width; ++x) {
            const std::size_t at = std::size_t(y) * image.width + x;
            bool is_uniform = true;
            for (const std::size_t line : {at - image.width, at, at + image.width})
                for (const std::size_t near : {line - 1, line, line + 1})
                    is_uniform = is_uniform && values[near] == values[at];
            uniform += is_uniform ? 1 : 0;
            different += is_uniform && others[at] != values[at] ? 1 : 0;
        }
    EXPECT_GT(uniform, values.size() / 3) << channel << ": too few to tell";
    EXPECT_EQ(different, 0u) << channel;
}

TEST_P(PhotonInvariance, ToTheBatchSize) {
    for (const bool direct : {false, true}) {
        RenderOptions with = options();
        with.direct_photons = direct;
        const Image image = render(scene(), with, "sppm").image;
        for (const std::uint32_t batch_size : {64u, 500u}) {
            with.batch_size = batch_size;
            EXPECT_TRUE(equal_bits(image, render(scene(), with, "sppm").image)) << "batch size " << batch_size;
        }
    }
}

TEST_P(PhotonInvariance, ToTheCropAndToLayers) {
    Scene part = scene();
    RenderOptions with = options();
    const Image whole = render(part, with, "sppm").image;
    with.aov = true;
    with.variance = false; // for which samples are drawn otherwise
    std::optional<Image> sampled;
    for (const bool direct : {false, true}) {
        with.direct_photons = direct;
        RenderOptions plain = with;
        plain.aov = false;
        const Image layered = render(part, with, "sppm").image;
        const Image image = render(part, plain, "sppm").image;
        for (const char *channel : {"R", "G", "B"})
            EXPECT_EQ(image.find(channel)->values, layered.find(channel)->values) << channel;
        // What the camera sees is what the path tracer says it is, wherever the samples in a pixel fall; and the same
        // by `shade` as by `gather`.
        const Image features = render(part, with, "pt").image;
        for (const char *channel : {"albedo.R", "albedo.B"})
            expect_alike_where_uniform(features, layered, channel);
        if (sampled) {
            for (const char *channel : {"albedo.R", "albedo.B", "normal.X", "normal.Z", "depth.Z"})
                EXPECT_EQ(sampled->find(channel)->values, layered.find(channel)->values) << channel;
        }
        sampled = layered;
    }
    part.film.crop_x = 13;
    part.film.crop_y = 7;
    part.film.crop_width = 31;
    part.film.crop_height = 29;
    const Image crop = render(part, options(), "sppm").image;
    std::size_t different = 0;
    for (std::uint32_t y = 0; y < crop.height; ++y)
        for (std::uint32_t x = 0; x < crop.width; ++x)
            different += pixel(crop, x, y) != pixel(whole, x + 13, y + 7) ? 1 : 0;
    EXPECT_EQ(different, 0u);
}

INSTANTIATE_TEST_SUITE_P(Photons, PhotonInvariance, ::testing::Values("cornell-box"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, PhotonInvariance, ::testing::Values("materials"), name_of_scene);

} // namespace
} // namespace gradus::testing
