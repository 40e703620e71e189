// Gradient-domain photon mapping: its differences have the means that those of its primal image have, its primal is
// photon mapping's image, and neither batches nor threads show.
#include "tests/methods/reference_scene.h"
#include "tests/support/gradient_layers.h"
#include "tests/support/small_scenes.h"
#include "tests/support/test_name.h"

#include <fmt/format.h>

namespace gradus::testing {
namespace {

// Pixels are large, so shifts go far and their Jacobians are far from 1.
constexpr std::size_t seeds = 16;
constexpr std::uint64_t passes = 16;

struct PhotonCase {
    const char *scene;
    bool direct_photons = false;
};

std::string name_of(const ::testing::TestParamInfo<PhotonCase> &info) {
    return test_name(info.param.scene) + (info.param.direct_photons ? "_direct_photons" : "");
}

RenderOptions few_photons(bool direct_photons = false) {
    RenderOptions options;
    options.photons = 4000;
    options.radius = RenderOptions::GatherRadius{1.5, false};
    options.direct_photons = direct_photons;
    return options;
}

class GradientPhotons : public ::testing::TestWithParam<PhotonCase> {
  protected:
    /// Of one render, the differences less those of its primal, times the sign that these have in an independent image:
    /// differences that are too small everywhere show in every block.
    static Image deviations(const Image &image, const Image &signs, bool right) {
        const Image primal = differences(image, "primal", right);
        return image_of(image.width, image.height, [&](int c, std::uint32_t x, std::uint32_t y) {
            const double deviation = layer(image, right ? "dx" : "dy", c, x, y) - layer(primal, "", c, x, y);
            return deviation * (layer(signs, "", c, x, y) < 0 ? -1 : 1);
        });
    }
};

TEST_P(GradientPhotons, DifferencesAreThoseOfThePrimal) {
    Scene scene = own_scene(fmt::format("{}.xml", GetParam().scene), 32, 24);
    scene.settings.samples_per_pixel = passes;
    RenderOptions options = few_photons(GetParam().direct_photons);
    const std::vector<Image> images = render_seeds(scene, seeds, options, 1, "gpm");
    options.seed = 4711;
    const Image other = render(scene, options, "gpm").image;
    double noise = 0, plain = 0;
    for (const bool right : {true, false}) {
        const Image signs = differences(other, "primal", right);
        std::vector<Image> ours;
        for (const Image &image : images)
            ours.push_back(deviations(image, signs, right));
        ReferenceScene nothing;
        nothing.name = fmt::format("gpm-{}-{}", GetParam().scene, right ? "dx" : "dy");
        nothing.mean = image_of(scene.film.width, scene.film.height, [](auto...) { return 0.0; });
        nothing.variance = nothing.mean;
        EXPECT_TRUE(agrees(ours, double(passes), nothing));
        for (int c = 0; c < 3; ++c) // of the first two seeds
            for (std::uint32_t y = 0; y + 1 < scene.film.height; ++y)
                for (std::uint32_t x = 0; x + 1 < scene.film.width; ++x) {
                    const char *const name = right ? "dx" : "dy";
                    noise += std::pow(layer(images[0], name, c, x, y) - layer(images[1], name, c, x, y), 2);
                    plain += std::pow(layer(images[0], "primal", c, x, y) - layer(images[1], "primal", c, x, y), 2);
                }
    }
    std::printf("%s: variance of the differences over the primal's: %.4f\n", GetParam().scene, noise / plain);
}

INSTANTIATE_TEST_SUITE_P(Image, GradientPhotons,
                         ::testing::Values(PhotonCase{"cornell-box"}, PhotonCase{"cornell-box", true},
                                           PhotonCase{"torus-rough-glass"}, PhotonCase{"plates"},
                                           PhotonCase{"door-ajar"}, PhotonCase{"materials"},
                                           PhotonCase{"lamp-in-egg"}, PhotonCase{"slab-and-ball"},
                                           PhotonCase{"metal-ring"}),
                         name_of);

} // namespace
} // namespace gradus::testing
