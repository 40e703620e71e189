#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/io/image_io.h"
#include "tests/film/make_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>

namespace gradus {
namespace {

namespace fs = std::filesystem;

class ImageFiles : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "gradus-image-XXXXXX").string();
        ASSERT_NE(::mkdtemp(name.data()), nullptr);
        folder = name;
    }
    void TearDown() override { fs::remove_all(folder); }

    std::string at(const std::string &name) const { return (folder / name).string(); }
    std::string bytes(const std::string &path) const {
        std::ifstream file(path, std::ios::binary);
        std::ostringstream text;
        text << file.rdbuf();
        return text.str();
    }
    std::size_t files() const {
        return std::size_t(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
    }
    template <typename Call>
    static ExitCode code_of(Call call, std::string *message = nullptr) {
        try {
            call();
        } catch (const Error &error) {
            if (message)
                *message = error.what();
            return error.code;
        }
        return ExitCode::success;
    }

    fs::path folder;
};

/// Files are coded some rows at a time (runtime/io/image_io.cpp).
TEST_F(ImageFiles, ManyRowsComeBackInTheirPlaces) {
    constexpr std::uint32_t width = 3, height = 300;
    std::vector<float> values(width * height);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = float(i);
    std::vector<float> others(values.rbegin(), values.rend());
    const Image image = make_image(width, height, {{"B", others}, {"G", others}, {"R", values}});
    write_image(image, at("many.exr"));
    const Image copy = read_image(at("many.exr"));
    EXPECT_EQ(copy.find("R")->values, values);
    EXPECT_EQ(copy.find("G")->values, others);
    Image picture = image;
    for (Channel &channel : picture.channels)
        for (float &value : channel.values)
            value /= float(width * height);
    write_png(picture, at("many.png"));
    const Image shown = read_image(at("many.png"));
    for (std::size_t i = 0; i < values.size(); ++i)
        EXPECT_NEAR(shown.find("R")->values[i], picture.find("R")->values[i], 0.01) << i;
}

TEST_F(ImageFiles, RoundTripKeepsEveryBitOfEveryChannel) {
    const float infinity = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const float smallest = std::numeric_limits<float>::denorm_min(), largest = std::numeric_limits<float>::max();
    Image image = make_image(3, 2,
                             {{"R", {1e6f, infinity, -infinity, nan, 65520, 0}},
                              {"G", {1, 2, 3, 4, 5, 6}},
                              {"B", {smallest, largest, -largest, -0.0f, 1e-30f, 0.1f}},
                              {"normal.X", {-1, 0, 1, -1, 0, 1}},
                              {"depth.Z", {7, 8, 9, 10, infinity, 12}},
                              {"albedo.R", {0.1f, 0.2f, 0.3f, 0.4f, 0.5f, 0.6f}}});
    image.metadata = {{"spp", "64"}, {"scene", "a folder/scène.xml"}};
    write_image(image, at("image.exr"));
    const Image copy = read_image(at("image.exr"));
    EXPECT_EQ(copy.width, 3u);
    EXPECT_EQ(copy.height, 2u);
    EXPECT_EQ(copy.channels.size(), image.channels.size());
    for (const Channel &channel : image.channels) {
        const Channel *found = copy.find(channel.name);
        ASSERT_NE(found, nullptr) << channel.name;
        ASSERT_EQ(found->values.size(), 6u);
        EXPECT_EQ(std::memcmp(found->values.data(), channel.values.data(), 6 * sizeof(float)), 0) << channel.name;
    }
    EXPECT_EQ(copy.metadata.at("spp"), "64");
    EXPECT_EQ(copy.metadata.at("scene"), "a folder/scène.xml");
}

// Zip takes as long as a reconstruction.
TEST_F(ImageFiles, NoiseIsNotZipped) {
    constexpr std::uint32_t width = 200, height = 100;
    std::mt19937 random(1);
    for (const float noise : {0.0f, 1.0f}) {
        Image image = make_image(width, height, {});
        for (const char *name : {"B", "G", "R"}) {
            std::vector<float> values(width * height);
            for (float &value : values)
                value = 0.5f + noise * std::uniform_real_distribution<float>(0, 1)(random);
            image.channels.push_back({name, values});
        }
        write_image(image, at("image.exr"));
        EXPECT_EQ(fs::file_size(at("image.exr")) > 3 * width * height * sizeof(float), noise > 0);
        const Image copy = read_image(at("image.exr"));
        for (const Channel &channel : image.channels)
            EXPECT_EQ(copy.find(channel.name)->values, channel.values);
    }
}

TEST_F(ImageFiles, EqualImagesGiveEqualBytes) {
    const Image image = make_gray(2, 1, {1, 2});
    write_image(image, at("first.exr"));
    ::sleep(1); // a time stamp would have changed by then
    write_image(image, at("second.exr"));
    EXPECT_EQ(bytes(at("first.exr")), bytes(at("second.exr")));
    EXPECT_EQ(files(), 2u) << "a temporary file was left behind";
}

TEST_F(ImageFiles, PngIsReadBackLinear) {
    write_png(make_image(2, 1, {{"B", {0, 1}}, {"G", {0.5f, 0.25f}}, {"R", {1, 0.01f}}}), at("picture.png"));
    const Image copy = read_image(at("picture.png"));
    ASSERT_NE(copy.find("R"), nullptr);
    EXPECT_NEAR(copy.find("R")->values[0], 1, 1e-6);
    EXPECT_NEAR(copy.find("G")->values[0], 0.5f, 0.005f);
    EXPECT_NEAR(copy.find("B")->values[0], 0, 1e-6);
    EXPECT_NEAR(copy.find("R")->values[1], 0.01f, 0.002f);
    EXPECT_NEAR(copy.find("B")->values[1], 1, 1e-6);
}

TEST_F(ImageFiles, WhatCannotBeReadIsAnImageError) {
    std::string message;
    EXPECT_EQ(code_of([&] { read_image(at("none.exr")); }, &message), ExitCode::image);
    EXPECT_THAT(message, ::testing::HasSubstr("none.exr"));
    std::ofstream(at("text.exr")) << "no image at all";
    EXPECT_EQ(code_of([&] { read_image(at("text.exr")); }), ExitCode::image);
    write_image(make_gray(64, 64, std::vector<float>(64 * 64, 0.3f)), at("cut.exr"));
    fs::resize_file(at("cut.exr"), fs::file_size(at("cut.exr")) - 40);
    EXPECT_EQ(code_of([&] { read_image(at("cut.exr")); }), ExitCode::image);
}

TEST_F(ImageFiles, WhatCannotBeWrittenIsAnOutputErrorAndLeavesNothing) {
    const Image image = make_gray(1, 1, {1});
    for (const std::string &path :
         {at("missing/image.exr"), folder.string(), std::string("/dev/full"), std::string("/proc/image.exr")}) {
        std::string message;
        EXPECT_EQ(code_of([&] { write_image(image, path); }, &message), ExitCode::output) << path;
        EXPECT_THAT(message, ::testing::HasSubstr(path));
        EXPECT_EQ(code_of([&] { check_writable(path); }), ExitCode::output) << path;
    }
    EXPECT_EQ(code_of([&] { check_writable(at("fine.exr")); }), ExitCode::success);
    EXPECT_EQ(files(), 0u);
}

TEST_F(ImageFiles, AFileOverTheLimitLeavesTheOldOne) {
    write_file_atomically(at("file"), "old", 3);
    struct rlimit before = {};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    struct rlimit tight = before;
    tight.rlim_cur = 1000;
    setrlimit(RLIMIT_FSIZE, &tight);
    const std::string large(5000, 'x');
    std::string message;
    const ExitCode code = code_of([&] { write_file_atomically(at("file"), large.data(), large.size()); }, &message);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_EQ(code, ExitCode::output);
    EXPECT_THAT(message, ::testing::HasSubstr("File too large"));
    EXPECT_EQ(bytes(at("file")), "old");
    EXPECT_EQ(files(), 1u);
}

TEST_F(ImageFiles, AFileKeepsItsPermissions) {
    write_file_atomically(at("file"), "old", 3);
    fs::permissions(at("file"), fs::perms(0640));
    write_file_atomically(at("file"), "new", 3);
    EXPECT_EQ(bytes(at("file")), "new");
    EXPECT_EQ(fs::status(at("file")).permissions(), fs::perms(0640));
    fs::permissions(at("file"), fs::perms(0440));
    if (geteuid() == 0) // who may write to anything
        return;
    std::string message;
    EXPECT_EQ(code_of([&] { check_writable(at("file")); }, &message), ExitCode::output);
    EXPECT_THAT(message, ::testing::HasSubstr("write-protected"));
}

TEST_F(ImageFiles, LinksAreFollowed) {
    fs::create_directory(folder / "real");
    fs::create_symlink("real/target.exr", folder / "link.exr");
    write_image(make_gray(1, 1, {2}), at("link.exr"));
    EXPECT_TRUE(fs::is_symlink(at("link.exr")));
    EXPECT_EQ(read_image(at("real/target.exr")).find("R")->values[0], 2);
}

} // namespace
} // namespace gradus
