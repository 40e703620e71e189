// A caller's wish to stop is heard between bounces, and what was done before stays.
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

namespace gradus::testing {
namespace {

/// The camera is within a ball of mirrors, with a floor in it that is lit: paths go on for ever.
Scene endless() {
    SceneMaker maker(16, 8);
    maker.look({0, 0, 0.5}, {0, 0, -1}, 60);
    maker.sphere({0, 0, 0}, 4, maker.material(mirror()), -1, true);
    maker.parallelogram({-0.5f, -1, -2}, {0, 0, 1}, {1, 0, 0}, maker.material(two_sided(diffuse(0.5))));
    maker.point_light({5, 5, 5}, {0, 1, -1});
    return maker.scene;
}

TEST(Stop, IsHeardBetweenBounces) {
    for (const char *name : {"pt", "gpt", "sppm", "gpm"}) {
        SCOPED_TRACE(name);
        RenderOptions options;
        options.photons = 100;
        int asked = 0;
        options.stop = [&] { return ++asked > 20; };
        const std::unique_ptr<Method> method = make_method(name, shared_device(), endless(), options);
        EXPECT_THROW(
            {
                while (method->render_batch()) {
                }
            },
            Stopped);
        EXPECT_EQ(asked, 21);
        EXPECT_EQ(count_non_finite(method->last_image()), 0u);
    }
}

// Without a wish the same calls do not change a bit.
TEST(Stop, AsksWithoutATrace) {
    SceneMaker maker(16, 4);
    maker.look({0, 1, 4}, {0, 0, 0}, 40);
    maker.floor(-2, 2, 2, maker.material(diffuse(0.5)));
    maker.lamp({0, 2, 0}, 1, 1, 5, maker.material(diffuse(0)));
    for (const char *name : {"pt", "gpt"}) {
        RenderOptions options;
        int asked = 0;
        options.stop = [&] { return ++asked < 0; };
        const Image image = render(maker.scene, options, name).image;
        EXPECT_GT(asked, 1);
        EXPECT_EQ(image.find("R")->values, render(maker.scene, {}, name).image.find("R")->values);
    }
}

} // namespace
} // namespace gradus::testing
