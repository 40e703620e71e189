// OpenEXR files that others have written: those of ours are in image_files_test.cpp.
#include "runtime/error.h"
#include "runtime/io/image_io.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <pthread.h>
#include <unistd.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;

class ExrFile : public ::testing::Test {
  protected:
    void TearDown() override { std::filesystem::remove(path_); }

    std::string error() const {
        try {
            read_image(path_);
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::image);
            return error.what();
        }
        return {};
    }

    const std::string path_ = ::testing::TempDir() + "gradus-exr-" + std::to_string(::getpid()) + ".exr";
};

// Threads of which each asks for more stack than there are addresses: the system starts none.
TEST_F(ExrFile, IsWrittenWhereNoThreadCanBeStarted) {
    Imf::setGlobalThreadCount(0);
    pthread_attr_t usual, none;
    ASSERT_EQ(pthread_getattr_default_np(&usual), 0);
    ASSERT_EQ(pthread_attr_init(&none), 0);
    ASSERT_EQ(pthread_attr_setstacksize(&none, std::size_t(1) << 50), 0);
    ASSERT_EQ(pthread_setattr_default_np(&none), 0);
    Image image;
    image.width = image.height = 600; // more than the caller would write alone
    image.channels.push_back({"Y", std::vector<float>(600 * 600, 0.5f)});
    EXPECT_NO_THROW(write_image(image, path_));
    ASSERT_EQ(pthread_setattr_default_np(&usual), 0);
    EXPECT_EQ(Imf::globalThreadCount(), 0);
    EXPECT_EQ(read_image(path_).channels.at(0).values, image.channels[0].values);
}

// 23 x 9 pixels that begin left of and below the origin, in tiles of 8 x 4.
TEST_F(ExrFile, TilesOfHalvesAndWholeNumbersFarFromTheOrigin) {
    const Imath::Box2i window({-5, 100}, {17, 108}), display({0, 0}, {9, 9});
    Imf::Header header(display, window);
    header.setTileDescription(Imf::TileDescription(8, 4, Imf::ONE_LEVEL));
    header.insert("comments", Imf::StringAttribute("of another program"));
    header.insert("frame", Imf::IntAttribute(-7));
    header.insert("gain", Imf::FloatAttribute(0.5f));
    std::vector<half> red(23 * 9);
    std::vector<std::uint32_t> object(23 * 9);
    for (std::size_t i = 0; i < red.size(); ++i) {
        red[i] = half(float(i) / 8);
        object[i] = 65536 + std::uint32_t(i);
    }
    header.channels().insert("R", Imf::Channel(Imf::HALF));
    header.channels().insert("object", Imf::Channel(Imf::UINT));
    Imf::FrameBuffer planes;
    planes.insert("R", Imf::Slice::Make(Imf::HALF, red.data(), window));
    planes.insert("object", Imf::Slice::Make(Imf::UINT, object.data(), window));
    {
        Imf::TiledOutputFile output(path_.c_str(), header);
        output.setFrameBuffer(planes);
        output.writeTiles(0, output.numXTiles() - 1, 0, output.numYTiles() - 1);
    }
    const Image image = read_image(path_);
    EXPECT_EQ(image.width, 23u);
    EXPECT_EQ(image.height, 9u);
    for (std::size_t i = 0; i < red.size(); ++i) {
        EXPECT_EQ(image.find("R")->values[i], float(i) / 8) << i;
        EXPECT_EQ(image.find("object")->values[i], 65536 + float(i)) << i;
    }
    EXPECT_EQ(image.origin, (PixelPlace{-5, 100}));
    EXPECT_EQ(image.metadata.at("comments"), "of another program");
    EXPECT_EQ(image.metadata.at("frame"), "-7");
    EXPECT_EQ(image.metadata.at("gain"), "0.5");
    write_image(image, path_);
    const Image again = read_image(path_);
    EXPECT_EQ(again.origin, image.origin);
    EXPECT_EQ(again.find("object")->values, image.find("object")->values);
}

TEST_F(ExrFile, PartsOfDifferentPlacesAreRefused) {
    const auto write_parts = [&](int y) {
        std::vector<Imf::Header> headers;
        for (const int top : {0, y}) {
            headers.emplace_back(Imath::Box2i({0, 0}, {9, 9}), Imath::Box2i({0, top}, {3, top + 1}));
            headers.back().setType(Imf::SCANLINEIMAGE);
            headers.back().setName("part " + std::to_string(headers.size()));
            headers.back().channels().insert("R", Imf::Channel(Imf::FLOAT));
        }
        Imf::MultiPartOutputFile output(path_.c_str(), headers.data(), int(headers.size()));
        std::vector<float> red(4 * 2, 1.0f);
        for (int part = 0; part < 2; ++part) {
            Imf::FrameBuffer planes;
            planes.insert("R", Imf::Slice::Make(Imf::FLOAT, red.data(), headers[std::size_t(part)].dataWindow()));
            Imf::OutputPart lines(output, part);
            lines.setFrameBuffer(planes);
            lines.writePixels(2);
        }
    };
    write_parts(2);
    EXPECT_THAT(error(), HasSubstr("part 1 begins at pixel (0, 2), the first one at (0, 0)"));
    write_parts(0);
    EXPECT_EQ(error(), "");
}

TEST_F(ExrFile, ColoursComeInTheirOrderLayerByLayer) {
    Image image;
    image.width = image.height = 1;
    for (const char *name : {"Z", "depth.Z", "R", "albedo.B", "G", "albedo.R", "A", "B", "albedo.G", "Red"})
        image.channels.push_back({name, {1.0f}});
    write_image(image, path_);
    std::vector<std::string> names;
    for (const Channel &channel : read_image(path_).channels)
        names.push_back(channel.name);
    EXPECT_THAT(names,
                ::testing::ElementsAre("R", "G", "B", "A", "Red", "Z", "albedo.R", "albedo.G", "albedo.B", "depth.Z"));
}

TEST_F(ExrFile, ColoursOfEveryOtherPixelAreRefused) {
    const std::vector<Imf::Rgba> pixels(16 * 16, Imf::Rgba(half(1.0f), half(0.5f), half(0.25f)));
    {
        Imf::RgbaOutputFile output(path_.c_str(), 16, 16, Imf::WRITE_YC);
        output.setFrameBuffer(pixels.data(), 1, 16);
        output.writePixels(16);
    }
    EXPECT_THAT(error(), HasSubstr("its channel 'BY' has not a value for each pixel"));
}

TEST_F(ExrFile, DeepImagesAreRefused) {
    Imf::Header header(2, 2);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.channels().insert("R", Imf::Channel(Imf::FLOAT));
    { Imf::DeepScanLineOutputFile output(path_.c_str(), header); }
    EXPECT_THAT(error(), HasSubstr("deep images are not supported"));
}

} // namespace
} // namespace gradus
