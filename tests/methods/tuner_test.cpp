// The tuner: what it tries has the same image, and it takes nothing that does not gain.
#include "planning/tuner.h"
#include "runtime/wavefront/table.h"
#include "tests/methods/reference_scene.h"
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

namespace gradus::testing {
namespace {

/// Passes are some hundred thousand paths long whatever the scene: short paths keep them short.
Scene small_room() {
    Scene scene = own_scene("cornell-box.xml", 48, 48);
    scene.settings.max_depth = 2;
    return scene;
}

TEST(FullTuner, TriesOnlyWhatHasTheSameImage) {
    TuningOptions options;
    options.turns = 3;
    options.seconds_a_turn = 0.005;
    Scene endless = small_room();
    endless.settings.samples_per_pixel = 1u << 30;
    std::size_t told = 0;
    options.on_trial = [&](const TuningTrial &) { ++told; };
    const TuningReport report = tune(shared_device(), "pt", small_room(), options);
    EXPECT_EQ(told, report.trials.size());
    EXPECT_GE(report.trials.size(), 5u);
    const auto method = make_method("pt", shared_device(), endless, {});
    method->render_batch();
    const auto by_default = std::uint32_t(method->done_samples() / batches_a_pass);
    bool is_larger_tried = false, is_tried = report.chosen == Tuning{};
    for (const TuningTrial &trial : report.trials) {
        EXPECT_TRUE(trial.failure.empty()) << name_of(trial.tuning) << ": " << trial.failure;
        EXPECT_TRUE(trial.same_image) << name_of(trial.tuning);
        EXPECT_EQ(trial.gains.size(), 3u);
        EXPECT_NE(trial.tuning.batch_size, by_default) << "that is what it is compared with";
        is_larger_tried = is_larger_tried || trial.tuning.batch_size > by_default;
        is_tried = is_tried || (trial.tuning == report.chosen && trial.median_gain >= 1.03);
    }
    EXPECT_TRUE(is_tried) << name_of(report.chosen);
    EXPECT_TRUE(is_larger_tried);
}

TEST(Tuner, LeavesOutWhatTheDeviceDoesNotTake) {
    TuningOptions options;
    options.turns = 1;
    options.seconds_a_turn = 0.001;
    const TuningTrial trial = try_tuning(shared_device(), "pt", small_room(), {1u << 20, 0}, options);
    EXPECT_FALSE(trial.failure.empty());
    EXPECT_TRUE(trial.gains.empty());
}

struct TunedImage {
    const char *method, *scene;
    std::vector<std::uint32_t> work_groups; ///< each has kernels of its own to compile
};

class TunedImages : public ::testing::TestWithParam<TunedImage> {};

TEST_P(TunedImages, AreTheSameBitForBit) {
    const auto &[method, name, work_groups] = GetParam();
    Scene scene = own_scene(std::string(name) + ".xml", 64, 48);
    scene.settings.samples_per_pixel = 4;
    const Image image = render(scene, {}, method).image;
    for (const std::uint32_t work_group : work_groups) {
        RenderOptions options;
        options.work_group_size = work_group;
        options.batch_size = 1000;
        EXPECT_TRUE(equal_bits(image, render(scene, options, method).image)) << work_group;
    }
}

INSTANTIATE_TEST_SUITE_P(Full, TunedImages,
                         ::testing::Values(TunedImage{"pt", "materials", {16, 32, 128, 256}},
                                           TunedImage{"gpt", "cornell-box", {16, 128, 256}}),
                         [](const auto &info) { return std::string(info.param.method); });

} // namespace
} // namespace gradus::testing
