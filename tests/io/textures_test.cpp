// Textures from scene files: plugins in both dialects, picture formats, and what is wrong with files.
#include "tests/io/scene_text.h"

#include <OpenImageIO/imageio.h>

#include <cmath>

namespace gradus {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class TexturePlugin : public ::testing::Test {
  protected:
    /// Writes 2 x 2 texels, channel after channel rising by a tenth of the largest value.
    template <class Value>
    void write(const std::string &name, int channels, OIIO::TypeDesc type, double largest) {
        std::vector<Value> values;
        for (int i = 0; i < 4 * channels; ++i)
            values.push_back(Value(largest * i / 16));
        write_values(name, 2, 2, channels, type, values.data());
    }
    void write_values(const std::string &name, int width, int height, int channels, OIIO::TypeDesc type,
                      const void *values) {
        const std::string path = (folder_.path() / name).string();
        const auto output = OIIO::ImageOutput::create(path);
        OIIO::ImageSpec spec(width, height, channels, type);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        spec.attribute("CompressionQuality", 100);
        ASSERT_TRUE(output && output->open(path, spec) && output->write_image(type, values) && output->close());
    }
    LoadedScene load(const std::string &texture, const std::string &version = "3.0.0",
                     const std::string &parameter = "reflectance", const std::string &bsdf = "diffuse") {
        return load_scene(folder_.write("scene.xml", text_of(texture, version, parameter, bsdf)));
    }
    std::string error(const std::string &texture, const std::string &parameter = "reflectance",
                      const std::string &bsdf = "diffuse") {
        return error_of(folder_.write("scene.xml", text_of(texture, "3.0.0", parameter, bsdf)));
    }
    /// The one texture of a file without warnings.
    Texture texture(const std::string &text, const std::string &version = "3.0.0") {
        const LoadedScene loaded = load(text, version);
        EXPECT_THAT(loaded.warnings, IsEmpty());
        EXPECT_EQ(loaded.scene.textures.size(), 1u);
        EXPECT_EQ(loaded.scene.materials.at(0).front.reflectance.texture, 0);
        return loaded.scene.textures.at(0);
    }
    /// The value in the middle of a texel of a picture of 2 x 2.
    static std::array<double, 3> texel(const Texture &texture, int x, int y) {
        return texture_value(texture, x / 2.0 + 0.25, y / 2.0 + 0.25);
    }
    TemporaryFolder folder_;

  private:
    static std::string text_of(std::string texture, const std::string &version, const std::string &parameter,
                               const std::string &bsdf) {
        texture.insert(texture.find("type="), "name=\"" + parameter + "\" ");
        return scene_around("<shape type=\"cube\"><bsdf type=\"" + bsdf + "\">" + texture +
                                "</bsdf></shape><emitter type=\"constant\"/>",
                            version, "");
    }
};

std::string bitmap_text(const std::string &file, const std::string &inside = "") {
    return "<texture type=\"bitmap\"><string name=\"filename\" value=\"" + file + "\"/>" + inside + "</texture>";
}

double linear(double encoded) { return srgb_to_linear_value(encoded); }

TEST_F(TexturePlugin, BitmapDefaults) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    const Texture found = texture(bitmap_text("a.png"));
    EXPECT_EQ(found.wrap, Texture::Wrap::repeat);
    EXPECT_FALSE(found.is_nearest);
    EXPECT_TRUE(found.is_srgb);
    EXPECT_EQ(found.bitmap->format, Bitmap::Format::byte);
    EXPECT_TRUE(found.bitmap->is_color);
    EXPECT_EQ(found.bitmap->words.size(), 4u); // a word each
    EXPECT_NEAR(texel(found, 1, 0)[2], linear(79 / 255.0), 1e-9);
    EXPECT_EQ(found.to_uv, Texture().to_uv);
}

TEST_F(TexturePlugin, BitmapOfEachFormat) {
    write<std::uint8_t>("gray.png", 1, OIIO::TypeDesc::UINT8, 255);
    write<std::uint8_t>("gray-alpha.png", 2, OIIO::TypeDesc::UINT8, 255);
    write<std::uint8_t>("alpha.png", 4, OIIO::TypeDesc::UINT8, 255);
    write<std::uint8_t>("a.tga", 3, OIIO::TypeDesc::UINT8, 255);
    write<std::uint16_t>("a16.png", 3, OIIO::TypeDesc::UINT16, 65535);
    write<float>("a.exr", 3, OIIO::TypeDesc::FLOAT, 1);
    write<float>("a.hdr", 3, OIIO::TypeDesc::FLOAT, 1);
    const Texture gray = texture(bitmap_text("gray.png"));
    EXPECT_FALSE(gray.bitmap->is_color);
    EXPECT_EQ(gray.bitmap->words.size(), 1u);
    EXPECT_NEAR(texel(gray, 1, 1)[2], linear(47 / 255.0), 1e-9);
    const Texture gray_alpha = texture(bitmap_text("gray-alpha.png"));
    EXPECT_FALSE(gray_alpha.bitmap->is_color);
    EXPECT_NEAR(texel(gray_alpha, 1, 0)[0], linear(31 / 255.0), 1e-9);
    // Colours are those of the file, not times alpha.
    EXPECT_NEAR(texel(texture(bitmap_text("alpha.png")), 0, 1)[1], linear(143 / 255.0), 1e-9);
    EXPECT_NEAR(texel(texture(bitmap_text("a.tga")), 1, 0)[2], linear(79 / 255.0), 1e-9);
    const Texture wide = texture(bitmap_text("a16.png"));
    EXPECT_EQ(wide.bitmap->format, Bitmap::Format::real); // sRGB of 16 bits
    EXPECT_NEAR(texel(wide, 1, 0)[2], linear(20479 / 65535.0), 1e-7);
    const Texture raw = texture(bitmap_text("a16.png", "<boolean name=\"raw\" value=\"true\"/>"));
    EXPECT_EQ(raw.bitmap->format, Bitmap::Format::word);
    EXPECT_NEAR(texel(raw, 1, 0)[2], 20479 / 65535.0, 1e-12);
    EXPECT_NEAR(texel(texture(bitmap_text("a.exr")), 1, 0)[2], 5 / 16.0, 1e-7);
    EXPECT_NEAR(texel(texture(bitmap_text("a.hdr")), 1, 0)[2], 5 / 16.0, 1 / 256.0);
}

TEST_F(TexturePlugin, BitmapInHalfPrecision) {
    const std::uint16_t halves[] = {0x3c00, 0x3800, 0x0001, 0x7c00, 0x3400, 0x3000,
                                    0x3c00, 0x3800, 0x0001, 0,      0,      0x2c00};
    write_values("h.exr", 2, 2, 3, OIIO::TypeDesc::HALF, halves);
    const LoadedScene loaded = load(bitmap_text("h.exr"));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("1 values that are no finite numbers become 0")));
    const Texture &found = loaded.scene.textures.at(0);
    EXPECT_EQ(found.bitmap->format, Bitmap::Format::half);
    EXPECT_EQ(texel(found, 0, 0), (std::array<double, 3>{1, 0.5, 0x1p-24}));
    EXPECT_EQ(texel(found, 1, 0), (std::array<double, 3>{0, 0.25, 0.125}));
}

TEST_F(TexturePlugin, BitmapParameters) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    const Texture found = texture(bitmap_text(
        "a.png", "<string name=\"filter_type\" value=\"nearest\"/><string name=\"wrap_mode\" value=\"mirror\"/>"
                 "<boolean name=\"raw\" value=\"true\"/><transform name=\"to_uv\"><scale x=\"2\" y=\"3\"/>"
                 "<translate x=\"0.25\" y=\"0.5\"/></transform>"));
    EXPECT_TRUE(found.is_nearest);
    EXPECT_FALSE(found.is_srgb);
    EXPECT_EQ(found.wrap, Texture::Wrap::mirror);
    EXPECT_THAT(found.to_uv, ElementsAre(2, 0, 0.25f, 0, 3, 0.5f));
    const Texture legacy = texture(
        bitmap_text("a.png", "<string name=\"filterType\" value=\"trilinear\"/><string name=\"wrapMode\" "
                             "value=\"clamp\"/><float name=\"gamma\" value=\"1\"/><float name=\"uscale\" value=\"2\"/>"
                             "<float name=\"voffset\" value=\"0.5\"/><string name=\"channel\" value=\"g\"/>"),
        "0.6.0");
    EXPECT_FALSE(legacy.is_nearest);
    EXPECT_FALSE(legacy.is_srgb);
    EXPECT_EQ(legacy.wrap, Texture::Wrap::clamp);
    EXPECT_THAT(legacy.to_uv, ElementsAre(2, 0, 0, 0, 1, 0.5f));
    EXPECT_FALSE(legacy.bitmap->is_color);
    EXPECT_NEAR(texture_value(legacy, 0, 0)[0], 111 / 255.0 * 0.5 + 15 / 255.0 * 0.5, 0.01);
}

TEST_F(TexturePlugin, Checkerboard) {
    const Texture found = texture("<texture type=\"checkerboard\"/>");
    EXPECT_NEAR(texture_value(found, 0.1, 0.1)[0], 0.4, 1e-7);
    EXPECT_NEAR(texture_value(found, 0.6, 0.1)[0], 0.2, 1e-7);
    const Texture legacy = texture("<texture type=\"checkerboard\"><rgb name=\"color0\" value=\"1 0 0\"/><float "
                                   "name=\"uscale\" value=\"2\"/></texture>",
                                   "0.5.0");
    EXPECT_NEAR(texture_value(legacy, 0.3, 0.1)[0], 0.2, 1e-7);
    EXPECT_EQ(texture_value(legacy, 0.1, 0.1), (std::array<double, 3>{1, 0, 0}));
}

TEST_F(TexturePlugin, Scale) {
    const Texture found = texture(
        "<texture type=\"scale\"><texture type=\"checkerboard\"/><float name=\"scale\" value=\"0.5\"/></texture>",
        "0.6.0");
    EXPECT_NEAR(texture_value(found, 0.1, 0.1)[0], 0.2, 1e-7);
}

TEST_F(TexturePlugin, RoughnessCountsWithItsLeast) {
    write<std::uint8_t>("a.png", 1, OIIO::TypeDesc::UINT8, 255);
    const LoadedScene loaded =
        load(bitmap_text("a.png", "<boolean name=\"raw\" value=\"true\"/>"), "3.0.0", "alpha", "roughconductor");
    EXPECT_THAT(loaded.warnings, IsEmpty()); // 0 is kept at 1e-4 without a word, as a number is
    const Bsdf &bsdf = loaded.scene.materials.at(0).front;
    EXPECT_EQ(bsdf.alpha_u.texture, 0);
    EXPECT_EQ(bsdf.alpha_v.texture, 0);
    EXPECT_FLOAT_EQ(bsdf.alpha_u.value, 1e-4f);
}

TEST_F(TexturePlugin, IsReadOnce) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    const std::string inside = "<string name=\"filename\" value=\"a.png\"/></texture>";
    const LoadedScene loaded = load_scene(folder_.write(
        "scene.xml", scene_around("<texture type=\"bitmap\" id=\"t\">" + inside +
                                  "<bsdf type=\"diffuse\" id=\"a\"><ref name=\"reflectance\" id=\"t\"/></bsdf>"
                                  "<bsdf type=\"diffuse\" id=\"b\"><ref name=\"reflectance\" id=\"t\"/></bsdf>"
                                  "<bsdf type=\"diffuse\" id=\"c\"><texture name=\"reflectance\" type=\"bitmap\">" +
                                  inside +
                                  "</bsdf><shape type=\"cube\"><ref id=\"a\"/></shape>"
                                  "<shape type=\"cube\"><ref id=\"b\"/></shape>"
                                  "<shape type=\"cube\"><ref id=\"c\"/></shape>")));
    ASSERT_EQ(loaded.scene.textures.size(), 2u);
    EXPECT_EQ(loaded.scene.textures[0].bitmap, loaded.scene.textures[1].bitmap);
    EXPECT_EQ(loaded.scene.materials.at(0).front.reflectance.texture,
              loaded.scene.materials.at(1).front.reflectance.texture);
}

TEST_F(TexturePlugin, ValuesBeyondTheRangeAreClampedWithAWarning) {
    const float values[] = {2, 0.5f, -1, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
    write_values("a.exr", 2, 2, 3, OIIO::TypeDesc::FLOAT, values);
    const LoadedScene loaded = load(bitmap_text("a.exr", "<string name=\"filter_type\" value=\"nearest\"/>"));
    EXPECT_THAT(loaded.warnings, ElementsAre(HasSubstr("from -1 to 2; they are clamped to 0 to 1")));
    EXPECT_EQ(texel(loaded.scene.textures.at(0), 0, 0), (std::array<double, 3>{1, 0.5, 0}));
}

TEST_F(TexturePlugin, Errors) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    EXPECT_THAT(error(bitmap_text("none.png")), HasSubstr("cannot find the file \"none.png\""));
    folder_.write("bad.png", "\x89PNG\r\n\x1a\nnothing");
    EXPECT_THAT(error(bitmap_text("bad.png")), HasSubstr("cannot read the texture"));
    EXPECT_THAT(error(bitmap_text("a.png", "<string name=\"filter_type\" value=\"cubic\"/>")),
                HasSubstr("unknown filter_type \"cubic\" (known: bilinear, nearest)"));
    EXPECT_THAT(error(bitmap_text("a.png", "<string name=\"wrap_mode\" value=\"zero\"/>")),
                HasSubstr("unknown wrap_mode \"zero\" (known: repeat, mirror, clamp)"));
    EXPECT_THAT(error("<texture type=\"bitmep\"/>"), HasSubstr("did you mean \"bitmap\"?"));
    EXPECT_THAT(error("<texture type=\"scale\"/>"), HasSubstr("scale needs one nested texture, not 0"));
    EXPECT_THAT(error(bitmap_text("a.png"), "eta", "conductor"), HasSubstr("conductor needs both eta and k"));
    EXPECT_THAT(error("<texture type=\"bitmap\"/>"), HasSubstr("bitmap needs a filename"));
}

/// A file of a kilobyte may declare any number of pixels.
TEST_F(TexturePlugin, BombsAreRefused) {
    std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x75\x30\0\0\x75\x30\x08\x02\0\0\0", 29); // 30000 x 30000
    // Its CRC: libpng asks for it.
    std::uint32_t crc = 0xffffffffu;
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= std::uint8_t(png[i]);
        for (int bit = 0; bit < 8; ++bit)
            crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    for (int shift = 24; shift >= 0; shift -= 8)
        png += char(~crc >> shift & 255);
    png += std::string("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
    folder_.write("bomb.png", png);
    EXPECT_THAT(error(bitmap_text("bomb.png")), HasSubstr("far more than a file of its size holds"));
}

} // namespace
} // namespace gradus
