// What was done stays: where a caller wishes to stop, which is heard between bounces, and where the reconstruction
// fails.
#include "runtime/device/opencl.h"
#include "runtime/error.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

namespace gradus::testing {
namespace {

/// Paths end only where they leave the room: of 2048, many go on for longer than is asked for.
Scene endless() {
    Scene scene = own_scene("cornell-box.xml", 16, 16);
    scene.settings.samples_per_pixel = 8;
    scene.settings.max_depth = scene.settings.rr_depth = -1;
    return scene;
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
        // The time of what was given up counts, too.
        const Statistics statistics = method->statistics();
        double seconds = 0;
        for (const StageTime &stage : statistics.stages)
            seconds += stage.seconds;
        EXPECT_GT(seconds, 0);
        EXPECT_NEAR(seconds, statistics.render_seconds, 1e-2 * statistics.render_seconds);
    }
}

// Nobody waits for the other kernels of an image that will not be made.
TEST(Stop, EndsTheCompilingOfAReconstruction) {
    Device device;
    RenderOptions options;
    options.stop = [] { return true; };
    std::unique_ptr<Method> method = make_method("gpt", device, endless(), options);
    device.implementation().store = ProgramStore(); // which knows what the reconstruction needs
    const std::size_t before = device.implementation().compiled;
    EXPECT_THROW(method->render_batch(), Stopped);
    method.reset();
    EXPECT_LT(device.implementation().compiled, before + 4); // of eleven
}

// The pass that is given up leaves nothing in any layer, wherever it ends.
TEST(Stop, AnImageOfPhotonsIsThatOfItsPasses) {
    SceneMaker maker(16, 16);
    maker.look({0, 1, 4}, {0, 0, 0}, 40);
    maker.floor(-2, 0, 2, maker.material(diffuse(0.5)));
    maker.floor(0, 2, 2, maker.material(mirror())); // photons at what it shows are gathered after those beside it
    maker.parallelogram({-3, 3, -3}, {6, 0, 0}, {0, 0, 6}, maker.material(diffuse(0.5)));
    maker.lamp({0, 2, 0}, 1, 1, 5, maker.material(diffuse(0)));
    maker.scene.settings.max_depth = 4;
    for (const char *name : {"sppm", "gpm"})
        for (int asks = 20; asks <= 32; ++asks) {
            SCOPED_TRACE(std::string(name) + ' ' + std::to_string(asks));
            Scene scene = maker.scene;
            scene.settings.samples_per_pixel = 100;
            RenderOptions options;
            options.photons = 3000;
            options.aov = true;
            int asked = 0;
            options.stop = [&] { return ++asked > asks; };
            const std::unique_ptr<Method> method = make_method(name, shared_device(), scene, options);
            EXPECT_THROW(
                {
                    while (method->render_batch()) {
                    }
                },
                Stopped);
            scene.settings.samples_per_pixel = std::uint32_t(method->statistics().samples / 256);
            ASSERT_GT(scene.settings.samples_per_pixel, 0u);
            options.stop = {};
            const Image found = method->last_image(), expected = render(scene, options, name).image;
            for (const Channel &channel : found.channels) {
                const Channel *const same = expected.find(channel.name);
                ASSERT_TRUE(same) << channel.name;
                EXPECT_TRUE(channel.values == same->values) << channel.name;
            }
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

// Pixels that no float holds are filled from their neighbours, which nobody should take for an image.
TEST(MeanImage, SaysWhichPixelsAReconstructionHasMadeUp) {
    SceneMaker maker(8, 256);
    maker.look({0, 1, 4}, {0, 0, 0}, 40);
    maker.floor(-2, 2, 2, maker.material(diffuse(0.5)));
    maker.lamp({0, 2, 0}, 1, 1, 5, maker.material(diffuse(0)));
    const auto lost = [&](const char *name) {
        RenderOptions options;
        options.reconstruction = Reconstruction::guided;
        options.photons = 1000;
        const std::unique_ptr<Method> method = make_method(name, shared_device(), maker.scene, options);
        while (method->render_batch()) {
        }
        method->last_image();
        return method->statistics().lost_pixels;
    };
    for (const char *name : {"pt", "gpt", "gpm"}) {
        maker.scene.emitters.at(0).value = {1, 1, 1};
        EXPECT_EQ(lost(name), 0u) << name;
        maker.scene.emitters.at(0).value = {3e38f, 1, 1};
        EXPECT_GT(lost(name), 8u) << name;
    }
}

// The device has no memory left when the image is to be made, for which a method has let go of its own.
TEST(MeanImage, IsThereWhereTheReconstructionFails) {
    Scene scene = own_scene("cornell-box.xml", 16, 16);
    scene.settings.samples_per_pixel = 8;
    DeviceDescription &device = shared_device().implementation().description;
    const DeviceDescription before = device;
    for (const auto &[name, reconstruction] : {std::pair{"gpt", Reconstruction::weighted},
                                               {"gpt", Reconstruction::l1},
                                               {"gpm", Reconstruction::guided},
                                               {"pt", Reconstruction::guided}}) {
        SCOPED_TRACE(std::string(name) + ' ' + reconstruction_name(reconstruction));
        RenderOptions options;
        options.photons = 100;
        options.reconstruction = reconstruction;
        const std::unique_ptr<Method> method = make_method(name, shared_device(), scene, options);
        while (method->render_batch()) {
        }
        const Image mean = method->mean_image();
        EXPECT_EQ(mean.channels.size(), 3u);
        device.allocation_bytes = 1;
        EXPECT_THROW(method->last_image(), Error);
        device = before;
        EXPECT_TRUE(equal_bits(mean, method->mean_image()));
        EXPECT_EQ(method->statistics().reconstruction.name, "none");
        EXPECT_FALSE(equal_bits(mean, render(scene, options, name).image));
    }
}

} // namespace
} // namespace gradus::testing
