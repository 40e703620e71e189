// Makes the corpus of pictures: make_pictures tests/fuzz/corpus. A few texels in each way that a format has of holding
// them, by OpenImageIO; those of exr have been there before.
#include <OpenImageIO/imageio.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

namespace {

struct Picture {
    const char *name; ///< folder and file
    int channels;
    OIIO::TypeDesc type;
    const char *compression = "";
    bool is_tiled = false;
};

const Picture pictures[] = {
    {"png/gray.png", 1, OIIO::TypeDesc::UINT8},
    {"png/gray-alpha.png", 2, OIIO::TypeDesc::UINT8},
    {"png/rgb.png", 3, OIIO::TypeDesc::UINT8},
    {"png/rgba.png", 4, OIIO::TypeDesc::UINT8},
    {"png/gray-16.png", 1, OIIO::TypeDesc::UINT16},
    {"png/rgba-16.png", 4, OIIO::TypeDesc::UINT16},
    {"jpg/gray.jpg", 1, OIIO::TypeDesc::UINT8},
    {"jpg/rgb.jpg", 3, OIIO::TypeDesc::UINT8},
    {"hdr/rgb.hdr", 3, OIIO::TypeDesc::FLOAT},
    {"tga/gray.tga", 1, OIIO::TypeDesc::UINT8, "none"},
    {"tga/rgb.tga", 3, OIIO::TypeDesc::UINT8, "none"},
    {"tga/rgba-rle.tga", 4, OIIO::TypeDesc::UINT8, "rle"},
    {"exr/half-tiled.exr", 4, OIIO::TypeDesc::HALF, "zip", true},
    {"exr/gray-float.exr", 1, OIIO::TypeDesc::FLOAT, "zips"},
};

bool make(const std::filesystem::path &path, const Picture &picture) {
    constexpr int width = 9, height = 5; // wider than 8: RGBE codes runs
    std::filesystem::create_directories(path.parent_path());
    const auto output = OIIO::ImageOutput::create(path.string());
    OIIO::ImageSpec spec(width, height, picture.channels, picture.type);
    if (*picture.compression)
        spec.attribute("compression", picture.compression);
    spec.attribute("DateTime", "2000:01:01 00:00:00");
    if (picture.is_tiled)
        spec.tile_width = spec.tile_height = 16;
    std::vector<float> values;
    for (int i = 0; i < width * height * picture.channels; ++i)
        values.push_back(float(i / 4 % 7) / 6);
    return output && output->open(path.string(), spec) && output->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
           output->close();
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 2)
        return 2;
    for (const Picture &picture : pictures)
        if (!make(std::filesystem::path(argv[1]) / picture.name, picture)) {
            std::fprintf(stderr, "cannot make %s: %s\n", picture.name, OIIO::geterror().c_str());
            return 1;
        }
}
