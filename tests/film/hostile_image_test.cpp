// Images that declare more than they hold: refused before anything is allocated.
#include "runtime/error.h"
#include "runtime/io/exr_header.h"
#include "runtime/io/image_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;

std::string bytes_of(std::uint32_t value) {
    return {char(value), char(value >> 8), char(value >> 16), char(value >> 24)};
}

class HostileImage : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(path_); }

    /// A file of ours with some of its bytes replaced, wherever they are found after `name`.
    void write_with(const std::string &name, std::size_t after, const std::string &bytes) {
        Image image;
        image.width = 4;
        image.height = 3;
        for (const char *channel : {"R", "G", "B"})
            image.channels.push_back({channel, std::vector<float>(12, 1.0f)});
        write_image(image, path_);
        std::ostringstream text;
        text << std::ifstream(path_, std::ios::binary).rdbuf();
        std::string file = text.str();
        const std::size_t at = file.find(name);
        ASSERT_NE(at, std::string::npos);
        file.replace(at + after, bytes.size(), bytes);
        std::ofstream(path_, std::ios::binary) << file;
    }
    std::string error(std::uint64_t limits = 1) const {
        try {
            read_image(path_, limits);
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::image);
            return error.what();
        }
        return {};
    }

    const std::string path_ = ::testing::TempDir() + "gradus-hostile-" + std::to_string(::getpid()) + ".exr";
};

// name, zero, "box2i", zero, size
constexpr std::size_t to_box = sizeof "dataWindow" + sizeof "box2i" + 4;

TEST_F(HostileImage, SizeIsReadFromTheHeader) {
    write_with("dataWindow", to_box, bytes_of(0) + bytes_of(0) + bytes_of(3) + bytes_of(2));
    const std::optional<ExrSize> size = exr_size(path_);
    ASSERT_TRUE(size);
    EXPECT_EQ(size->bytes, 4u * 3 * 3 * 4);
    EXPECT_EQ(error(), "");
    std::ofstream(path_) << "no image";
    EXPECT_FALSE(exr_size(path_));
}

TEST_F(HostileImage, PixelsThatNoFileHolds) {
    const std::uint32_t far = 0x7ffffffe;
    for (const auto &[width, height] : {std::pair{far, far}, std::pair{far, 3u}, std::pair{100000u, 100000u}}) {
        write_with("dataWindow", to_box, bytes_of(0) + bytes_of(0) + bytes_of(width) + bytes_of(height));
        EXPECT_THAT(error(), HasSubstr("--limits")) << width << "x" << height;
    }
    // From the most negative number on.
    write_with("dataWindow", to_box, bytes_of(0x80000000u) + bytes_of(0x80000000u) + bytes_of(far) + bytes_of(far));
    EXPECT_EQ(exr_size(path_)->bytes, std::numeric_limits<std::uint64_t>::max());
    EXPECT_THAT(error(), HasSubstr("--limits"));
}

/// Within the limit of pixels, but its table of lines would have to be longer than the file.
TEST_F(HostileImage, MoreLinesThanTheFileHolds) {
    write_with("dataWindow", to_box, bytes_of(0) + bytes_of(0) + bytes_of(3) + bytes_of(2000000));
    EXPECT_THAT(error(), HasSubstr("truncated or damaged"));
}

/// An attribute of half a gigabyte in a file of less than a kilobyte; a header without an end.
TEST_F(HostileImage, HeadersLongerThanTheFile) {
    write_with("lineOrder", sizeof "lineOrder" + sizeof "lineOrder", bytes_of(0x20000000u));
    EXPECT_FALSE(exr_size(path_)->is_whole);
    EXPECT_THAT(error(), HasSubstr("truncated or damaged"));
    std::filesystem::resize_file(path_, 100);
    EXPECT_THAT(error(), HasSubstr("truncated or damaged"));
}

/// Found by fuzzing: a channel of a type that there is not.
TEST_F(HostileImage, UnknownPixelType) {
    write_with("chlist", sizeof "chlist" + 4 + sizeof "B", bytes_of(3));
    EXPECT_THAT(error(), HasSubstr("truncated or damaged"));
}

TEST_F(HostileImage, ManyChannels) {
    Image image;
    image.width = image.height = 1;
    for (int i = 0; i < 1500; ++i)
        image.channels.push_back({"c" + std::to_string(i), {1.0f}});
    write_image(image, path_);
    EXPECT_THAT(error(), HasSubstr("more than 1024 channels"));
    EXPECT_EQ(error(10), "");
}

} // namespace
} // namespace gradus
