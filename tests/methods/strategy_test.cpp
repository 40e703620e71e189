// Light sampling alone, BSDF sampling alone and both combined estimate the same image.
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/test_name.h"

namespace gradus::testing {
namespace {

class Strategies : public ::testing::TestWithParam<const char *> {};

TEST_P(Strategies, Agree) {
    constexpr std::size_t seeds = 12;
    const std::string name = GetParam();
    // BSDF samples seldom meet the sundial's sun, a few texels of its map: with 384 samples in all a block's variance
    // is of those that happened to.
    const std::uint64_t samples_per_pixel = name == "sundial" ? 512 : 32;
    Scene scene = own_scene(name + ".xml", 64, 48);
    scene.settings.samples_per_pixel = samples_per_pixel;
    // BSDF sampling cannot meet lights of no extent.
    std::erase_if(scene.emitters, [](const Emitter &emitter) {
        return emitter.kind == Emitter::Kind::point || emitter.kind == Emitter::Kind::directional ||
               emitter.kind == Emitter::Kind::spot;
    });
    const auto images = [&](RenderOptions::Strategy strategy, std::uint64_t first_seed) {
        RenderOptions options;
        options.strategy = strategy;
        return render_seeds(scene, seeds, options, first_seed);
    };
    const std::vector<Image> mis = images(RenderOptions::Strategy::mis, 100);
    const std::vector<Image> light = images(RenderOptions::Strategy::light, 200);
    const std::vector<Image> bsdf = images(RenderOptions::Strategy::bsdf, 300);
    EXPECT_TRUE(agree(name + "-light-and-mis", light, mis, samples_per_pixel));
    EXPECT_TRUE(agree(name + "-bsdf-and-mis", bsdf, mis, samples_per_pixel));
    EXPECT_TRUE(agree(name + "-light-and-bsdf", light, bsdf, samples_per_pixel));
    // They would agree, too, if the option did nothing.
    EXPECT_FALSE(equal_bits(mis[0], light[0]));
    EXPECT_FALSE(equal_bits(mis[0], bsdf[0]));
}

INSTANTIATE_TEST_SUITE_P(Image, Strategies, ::testing::Values("cornell-box", "plates"), name_of_scene);
INSTANTIATE_TEST_SUITE_P(Full, Strategies, ::testing::Values("materials", "sundial"), name_of_scene);

} // namespace
} // namespace gradus::testing
