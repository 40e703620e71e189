// What must not change the images of photon mapping.
#include "tests/methods/photon_case.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/test_name.h"

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
    for (const bool direct : {false, true}) {
        with.direct_photons = direct;
        RenderOptions plain = with;
        plain.aov = false;
        const Image layered = render(part, with, "sppm").image;
        const Image image = render(part, plain, "sppm").image;
        for (const char *channel : {"R", "G", "B"})
            EXPECT_EQ(image.find(channel)->values, layered.find(channel)->values) << channel;
        // What the camera sees is what the path tracer says it is.
        const Image features = render(part, with, "pt").image;
        for (const char *channel : {"albedo.R", "albedo.B", "normal.X", "normal.Z", "depth.Z"})
            EXPECT_EQ(features.find(channel)->values, layered.find(channel)->values) << channel;
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

INSTANTIATE_TEST_SUITE_P(Photons, PhotonInvariance, ::testing::Values("cornell-box", "materials"), name_of_scene);

} // namespace
} // namespace gradus::testing
