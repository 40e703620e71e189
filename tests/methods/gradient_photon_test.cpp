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
constexpr std::size_t image_seeds = 16;
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
    const std::vector<Image> images = render_seeds(scene, image_seeds, options, 1, "gpm");
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
                                           PhotonCase{"slab-and-ball"}, PhotonCase{"metal-ring"}),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Full, GradientPhotons,
                         ::testing::Values(PhotonCase{"torus-rough-glass"}, PhotonCase{"plates"},
                                           PhotonCase{"door-ajar"}, PhotonCase{"materials"}, PhotonCase{"lamp-in-egg"}),
                         name_of);

class GradientPhotonsOf : public ::testing::TestWithParam<const char *> {
  protected:
    Scene small_scene(std::uint32_t width, std::uint32_t height, std::uint64_t count) const {
        Scene scene = own_scene(std::string(GetParam()) + ".xml", width, height);
        scene.settings.samples_per_pixel = count;
        return scene;
    }
};

/// Strips of some rows, and windows of a few pairs.
TEST_P(GradientPhotonsOf, DoNotDependOnBatches) {
    const Scene scene = small_scene(41, 31, 2);
    RenderOptions options = few_photons();
    const Image image = render(scene, options, "gpm").image;
    for (const std::uint32_t batch_size : {64u, 600u}) {
        options.batch_size = batch_size;
        EXPECT_TRUE(equal_bits(image, render(scene, options, "gpm").image)) << "batch size " << batch_size;
    }
}

TEST_P(GradientPhotonsOf, DoNotDependOnThreads) {
    const Scene scene = small_scene(24, 18, 2);
    RenderOptions options = few_photons();
    options.threads = 1;
    const Image image = render(scene, options, "gpm").image;
    options.threads = 3;
    EXPECT_TRUE(equal_bits(image, render(scene, options, "gpm").image));
    options.seed = 1;
    EXPECT_FALSE(equal_bits(image, render(scene, options, "gpm").image));
}

/// The base paths are photon mapping's: the same numbers, added up in another order.
TEST_P(GradientPhotonsOf, HaveThePrimalOfPhotonMapping) {
    Scene scene = small_scene(32, 24, 3);
    scene.settings.hide_emitters = true; // their edges are sampled anew
    RenderOptions options = few_photons();
    options.reconstruction = Reconstruction::l1; // no halves, which have numbers and radii of their own
    const Image primal = whole(render(scene, options, "gpm").image), plain = render(scene, options, "sppm").image;
    const double error = relative_mse(primal, plain);
    std::printf("%s: relMSE of both %.2g\n", GetParam(), error);
    EXPECT_LT(error, 1e-9); // float's rounding, squared, at some hundred sums
}

INSTANTIATE_TEST_SUITE_P(Methods, GradientPhotonsOf, ::testing::Values("cornell-box", "lamp-in-egg"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, GradientPhotonsOf, ::testing::Values("materials"), name_of_scene);

/// What the reconstruction gains where surfaces are diffuse, with the radii of the defaults.
TEST(GradientPhotonImage, HasFarLessErrorThanPhotonMapping) {
    ReferenceScene reference = own_reference("cornell-box");
    reference.scene.settings.samples_per_pixel = 4;
    RenderOptions options;
    options.photons = 250'000;
    const double ours = relative_mse(render(reference.scene, options, "gpm").image, reference.mean);
    const double plain = relative_mse(render(reference.scene, options, "sppm").image, reference.mean);
    std::printf("relMSE of 4 passes: gpm %.2e, sppm %.2e\n", ours, plain);
    EXPECT_LT(ours, 0.5 * plain);
}

/// All light on a floor comes through a ball of glass, from a point in it: chains alone make the very same image. In a
/// room of rough walls they make none.
TEST(GradientPhotonImage, OfChainsAlone) {
    SceneMaker maker(16, 2);
    maker.look({0, 3, 3}, {0, 0, 0}, 20);
    maker.scene.settings.max_depth = 6;
    maker.floor(-1, 1, 1, maker.material(diffuse(0.7)));
    maker.sphere({0, 1.5f, 0}, 0.3f, maker.material(glass(1.5)));
    maker.point_light({5, 5, 5}, {0.05f, 1.5f, 0});
    RenderOptions options = few_photons();
    const Image all = render(maker.scene, options, "gpm").image;
    options.only_chains = true;
    const Image chains = render(maker.scene, options, "gpm").image;
    EXPECT_GT(spread_of(chains, "primal.G").mean, 0);
    for (const char *channel : {"primal.G", "dx.R", "dy.B"})
        EXPECT_EQ(chains.find(channel)->values, all.find(channel)->values) << channel;
    Scene room = own_scene("cornell-box.xml", 16, 12);
    room.settings.samples_per_pixel = 2;
    const Image none = render(room, options, "gpm").image;
    for (const char *channel : {"primal.G", "dx.R", "dy.B"})
        EXPECT_EQ(spread_of(none, channel).most, 0) << channel;
}

/// A mirror that sees the sky, and no photon at all: nothing to shift, and nothing that is not finite.
TEST(GradientPhotonImage, IsFiniteWhereNothingIsGathered) {
    SceneMaker maker(24, 2);
    maker.look({0, 1, 5}, {0, 0, 0}, 40);
    maker.floor(-1, 1, 1, maker.material(diffuse(0.5f)));
    maker.sphere({0, 0.5f, 0}, 0.4f, maker.material(mirror()));
    maker.point_light({5, 5, 5}, {1, 3, 2});
    RenderOptions options = few_photons();
    options.photons = 1;
    render(maker.scene, options, "gpm");
}

} // namespace
} // namespace gradus::testing
