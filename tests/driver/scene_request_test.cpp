#include "driver/scene_request.h"

#include "runtime/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gradus {
namespace {

using ::testing::ElementsAre;

TEST(SceneRequest, Sizes) {
    EXPECT_THAT(parse_size("640x480"), ElementsAre(640, 480));
    EXPECT_THAT(parse_size("1x65536"), ElementsAre(1, 65536));
    for (const char *text : {"", "640", "640x", "x480", "0x1", "1x0", "-1x5", "+1x5", "640X480", "640 x 480",
                             "640x480 ", "65537x1", "99999999999x1", "1.5x2"})
        EXPECT_THROW(parse_size(text), Error) << text;
}

TEST(SceneRequest, Crops) {
    EXPECT_THAT(parse_crop("0,1,2,3"), ElementsAre(0, 1, 2, 3));
    for (const char *text : {"", "0,0,1", "0,0,1,1,1", "0,0,0,1", "0,0,1,0", "-1,0,1,1", "0,0,1,1,", "a,b,c,d"})
        EXPECT_THROW(parse_crop(text), Error) << text;
}

TEST(SceneRequest, Definitions) {
    EXPECT_EQ(parse_definition("a=b"), std::make_pair(std::string("a"), std::string("b")));
    EXPECT_EQ(parse_definition("a="), std::make_pair(std::string("a"), std::string()));
    EXPECT_EQ(parse_definition("a=b=c"), std::make_pair(std::string("a"), std::string("b=c")));
    EXPECT_THROW(parse_definition("a"), Error);
    EXPECT_THROW(parse_definition("=b"), Error);
}

Scene scene_with_crop() {
    Scene scene;
    scene.film = {100, 50, 10, 20, 30, 15, FilmSettings::Filter::box, 2, 0.5f};
    return scene;
}

TEST(SceneRequest, NothingAskedForChangesNothing) {
    Scene scene = scene_with_crop();
    apply_request({}, scene);
    EXPECT_EQ(scene.film.width, 100u);
    EXPECT_EQ(scene.film.crop_width, 30u);
    EXPECT_EQ(scene.settings.samples_per_pixel, 4u);
    EXPECT_EQ(scene.settings.max_depth, -1);
    EXPECT_THAT(image_size(scene.film), ElementsAre(30, 15));
}

TEST(SceneRequest, SizeDropsTheFilesCrop) {
    Scene scene = scene_with_crop();
    SceneRequest request;
    request.size = {{64, 32}};
    apply_request(request, scene);
    EXPECT_THAT(image_size(scene.film), ElementsAre(64, 32));
}

TEST(SceneRequest, CropsMustBeInsideTheFilm) {
    SceneRequest request;
    request.crop = {{70, 35, 30, 15}};
    Scene scene = scene_with_crop();
    apply_request(request, scene);
    EXPECT_EQ(scene.film.crop_x, 70u);
    EXPECT_THAT(image_size(scene.film), ElementsAre(30, 15));
    for (const std::array<std::uint32_t, 4> crop : {std::array<std::uint32_t, 4>{71, 35, 30, 15},
                                                    {70, 36, 30, 15},
                                                    {4294967295u, 0, 1, 1},
                                                    {0, 4294967295u, 1, 4294967295u}}) {
        request.crop = crop;
        EXPECT_THROW(apply_request(request, scene), Error);
    }
    // Of the new size, where one is given.
    request.size = {{200, 100}};
    request.crop = {{170, 85, 30, 15}};
    EXPECT_NO_THROW(apply_request(request, scene));
}

TEST(SceneRequest, SettingsAreReplaced) {
    Scene scene;
    SceneRequest request;
    request.samples_per_pixel = 7;
    request.max_depth = 3;
    request.rr_depth = 2;
    apply_request(request, scene);
    EXPECT_EQ(scene.settings.samples_per_pixel, 7u);
    EXPECT_EQ(scene.settings.max_depth, 3);
    EXPECT_EQ(scene.settings.rr_depth, 2);
}

TEST(SceneRequest, LoadHandsOnParametersAndWarnings) {
    Services services;
    services.load_scene = [](const std::string &path, const LoadOptions &options) {
        EXPECT_EQ(path, "a.xml");
        EXPECT_TRUE(options.strict);
        EXPECT_EQ(options.parameters.at("light"), "2,3");
        EXPECT_TRUE(options.confined);
        EXPECT_THAT(options.allowed_folders, ElementsAre("meshes"));
        EXPECT_EQ(options.limits.includes, 3 * LoadLimits().includes);
        LoadedScene loaded;
        loaded.warnings = {"first", "second"};
        return loaded;
    };
    SceneRequest request;
    request.path = "a.xml";
    request.definitions = {"light=2,3"};
    request.strict = true;
    request.confined = true;
    request.allowed_folders = {"meshes"};
    request.limits = 3;
    request.max_depth = 9;
    std::vector<std::string> warnings;
    const Scene scene =
        load_requested_scene(request, services, [&](const std::string &warning) { warnings.push_back(warning); });
    EXPECT_THAT(warnings, ElementsAre("first", "second"));
    EXPECT_EQ(scene.settings.max_depth, 9);
}

TEST(SceneRequest, HasCopiesOfInstancesForWhoRendersNone) {
    SceneRequest request;
    EXPECT_EQ(for_method(request, "gpm").instances, InstanceChoice::copies);
    EXPECT_EQ(for_method(request, "gpt").instances, InstanceChoice::automatic);
    request.instances = InstanceChoice::kept;
    EXPECT_EQ(for_method(request, "gpm").instances, InstanceChoice::kept);
}

} // namespace
} // namespace gradus
