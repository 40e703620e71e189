// Textures from scene files: plugins in both dialects, picture formats, and what is wrong with files.
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/image_io.h"
#include "runtime/scene/environment_map.h"
#include "tests/io/scene_text.h"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <ctime>
#include <sstream>

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
                      const void *values, const std::vector<std::string> &channel_names = {}) {
        const std::string path = (folder_.path() / name).string();
        const auto output = OIIO::ImageOutput::create(path);
        OIIO::ImageSpec spec(width, height, channels, type);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        spec.attribute("CompressionQuality", 100);
        if (!channel_names.empty())
            spec.channelnames = channel_names;
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

/// An image that is compared or solved, and that of an environment, is not times its alpha either.
TEST_F(TexturePlugin, ImagesAreNotTimesAlpha) {
    const std::uint8_t values[] = {200, 100, 50, 0, 200, 100, 50, 128, 200, 100, 50, 255, 200, 100, 50, 1};
    write_values("rgba.png", 2, 2, 4, OIIO::TypeDesc::UINT8, values);
    const Image image = read_image((folder_.path() / "rgba.png").string());
    for (const float value : image.find("G")->values)
        EXPECT_NEAR(value, linear(100 / 255.0), 1e-6);
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

/// A line lies on both sides of each whole number; what its width comes to is exact where a picture can have it.
TEST_F(TexturePlugin, GridOf0x) {
    for (const auto &[text, width] :
         {std::pair{"", 0.01}, std::pair{"<float name=\"lineWidth\" value=\"0.125\"/>", 0.125},
          std::pair{"<float name=\"lineWidth\" value=\"0.0317\"/>", 0.0317},
          std::pair{"<float name=\"lineWidth\" value=\"0\"/>", 0.0},
          std::pair{"<float name=\"lineWidth\" value=\"3\"/>", 0.5}}) {
        SCOPED_TRACE(text);
        const Texture found = texture("<texture type=\"gridtexture\">" + std::string(text) +
                                          "<rgb name=\"color1\" value=\"1 0.5 0.25\"/></texture>",
                                      "0.6.0");
        for (const double whole : {-1.0, 0.0, 1.0})
            for (const double from_whole : {-0.499, width + 1e-3, -width - 1e-3, width - 1e-3, 1e-3 - width}) {
                if (std::abs(from_whole) > 0.5)
                    continue;
                const double is_line = std::abs(from_whole) < width ? 1 : 0;
                const std::array<double, 3> color{0.2 + is_line * 0.8, 0.2 + is_line * 0.3, 0.2 + is_line * 0.05};
                for (const auto &[u, v] :
                     {std::pair{whole + from_whole, 0.5001}, std::pair{0.5001, whole + from_whole}})
                    for (std::size_t c = 0; c < 3; ++c)
                        EXPECT_NEAR(texture_value(found, u, v)[c], color[c], 1e-7) << u << ", " << v;
            }
    }
    const Texture scaled =
        texture("<texture type=\"gridtexture\"><float name=\"uscale\" value=\"4\"/></texture>", "0.6.0");
    EXPECT_NEAR(texture_value(scaled, 0.2505, 0.1)[0], 0.4, 1e-7);
    EXPECT_NEAR(texture_value(scaled, 0.125, 0.1)[0], 0.2, 1e-7);
    EXPECT_NEAR(texture_range(scaled).mean[0], 0.2 + 0.2 * (1 - 0.98 * 0.98), 1e-6);
}

/// As Mitsuba's RGB mode has them. They are numbers, not textures: nothing is looked up.
TEST(TextureOfOneColor, IsANumber) {
    const auto named = [](const std::string &tag, const std::string &name, const std::string &type_and_rest) {
        return "<" + tag + " name=\"" + name + "\" type=" + type_and_rest + "</" + tag + ">";
    };
    const auto loaded = [](const std::string &inside) {
        const LoadedScene scene = load_text(scene_around(inside + "<emitter type='constant'/>"));
        EXPECT_THAT(scene.warnings, IsEmpty()) << inside;
        EXPECT_THAT(scene.scene.textures, IsEmpty()) << inside;
        return scene.scene;
    };
    const auto bsdf = [&](const std::string &type, const std::string &inside) {
        return loaded("<shape type=\"cube\"><bsdf type=\"" + type + "\">" + inside + "</bsdf></shape>")
            .materials.at(0)
            .front;
    };
    const std::string uniform = "'uniform'><float name='value' value='0.25'/>",
                      srgb = "'srgb'><rgb name='color' value='0.1 0.2 0.3'/>",
                      d65 = "'d65'><rgb name='color' value='0.25 0.5 1'/><float name='scale' value='0.5'/>",
                      board = "'checkerboard'><float name='color0' value='0.5'/><float name='color1' value='0.5'/>";
    for (const char *tag : {"spectrum", "texture"}) {
        const auto reflectance = [&](const std::string &rest) {
            return bsdf("diffuse", named(tag, "reflectance", rest)).reflectance;
        };
        expect_rgb(reflectance(uniform), 0.25, 0.25, 0.25);
        expect_rgb(reflectance(srgb), 0.1, 0.2, 0.3);
        expect_rgb(reflectance(d65), 0.125, 0.25, 0.5);
        expect_rgb(reflectance("'d65'>"), 1, 1, 1);
        expect_rgb(reflectance(board), 0.5, 0.5, 0.5);
        EXPECT_EQ(reflectance(board).texture, no_texture);
        // A light takes more than 1 and has no tint; a roughness and an index take a number.
        const Scene lights =
            loaded("<shape type='cube'><emitter type='area'>" +
                   named(tag, "radiance", "'uniform'><float name='value' value='7'/>") +
                   "</emitter></shape><emitter type='point'>" + named(tag, "intensity", d65) + "</emitter>");
        expect_rgb(lights.emitters.back().value, 7, 7, 7);
        expect_rgb(lights.emitters.front().value, 0.125, 0.25, 0.5);
        EXPECT_EQ(bsdf("roughconductor", named(tag, "alpha", uniform)).alpha_u, 0.25f);
        EXPECT_FLOAT_EQ(bsdf("roughconductor", named(tag, "alpha", srgb)).alpha_u, 0.2f) << "the channels' mean";
        const Bsdf metal = bsdf("conductor", named(tag, "eta", uniform) + named(tag, "k", srgb));
        expect_rgb(metal.eta, 0.25, 0.25, 0.25);
        expect_rgb(metal.k, 0.1, 0.2, 0.3);
    }
    EXPECT_THAT(error_of_text(scene_around("<shape type='cube'><bsdf type='diffuse'>" +
                                           named("spectrum", "reflectance", "'irregular'>") + "</bsdf></shape>")),
                HasSubstr("the spectrum \"irregular\" is not known here"));
    EXPECT_THAT(error_of_text(scene_around("<emitter type='point'>" + named("texture", "intensity", "'checkerboard'>") +
                                           "</emitter>")),
                HasSubstr("cannot be a texture"));
    expect_rgb(load_text(scene_around("<spectrum type='srgb' id='c'><rgb name='color' value='0.1 0.2 0.3'/></spectrum>"
                                      "<emitter type='constant'/><shape type='cube'><bsdf type='diffuse'><ref "
                                      "name='reflectance' id='c'/></bsdf></shape>"))
                   .scene.materials.at(0)
                   .front.reflectance,
               0.1, 0.2, 0.3);
    // A map has a slope to look for.
    EXPECT_THAT(
        load_text(
            scene_around(
                "<emitter type='constant'/><shape type='cube'><bsdf type='bumpmap'><texture type='uniform'/><bsdf "
                "type='diffuse'/></bsdf></shape>"))
            .warnings,
        ElementsAre(HasSubstr("has no slope")));
}

/// A colour that stands for a number is its channels' mean, as in Mitsuba 3.9; a picture's texel is its luminance.
TEST(ColorForANumber, IsTheMeanOfItsChannels) {
    const auto scene = [](const std::string &bsdf) {
        const LoadedScene loaded =
            load_text(scene_around("<shape type='cube'>" + bsdf + "</shape><emitter type='constant'/>"));
        EXPECT_THAT(loaded.warnings, IsEmpty());
        return loaded.scene;
    };
    const std::string blue = "value='0 0 0.9'/>";
    const Bsdf metal = scene("<bsdf type='roughconductor'><rgb name='alpha' " + blue + "</bsdf>").materials[0].front;
    EXPECT_FLOAT_EQ(metal.alpha_u, 0.3f);
    EXPECT_FLOAT_EQ(
        scene("<bsdf type='mask'><rgb name='opacity' " + blue + "<bsdf type='diffuse'/></bsdf>").materials[0].opacity,
        0.3f);
    const Scene board = scene("<bsdf type='mask'><texture name='opacity' type='checkerboard'><rgb name='color0' " +
                              blue + "<rgb name='color1' value='0.3 0 0'/></texture><bsdf type='diffuse'/></bsdf>");
    ASSERT_EQ(board.textures.size(), 1u);
    EXPECT_FLOAT_EQ(float(texture_value(board.textures[0], 0.1, 0.1)[1]), 0.3f);
    EXPECT_FLOAT_EQ(float(texture_value(board.textures[0], 0.1, 0.6)[1]), 0.1f);
    EXPECT_THAT(error_of_text(scene_around("<shape type='cube'><bsdf type='mask'>\n<rgb name='opacity' value='1 2 3'/>"
                                           "<bsdf type='diffuse'/></bsdf></shape>")),
                HasSubstr("scene.xml:4: \"opacity\" is 1 2 3 but must be at least 0 and at most 1"));
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

TEST_F(TexturePlugin, RoughnessOfPhongCountsWithItsLeast) {
    const LoadedScene loaded = load("<texture type=\"checkerboard\"><float name=\"color0\" value=\"0\"/><float "
                                    "name=\"color1\" value=\"9998\"/></texture>",
                                    "0.6.0", "exponent", "phong");
    const Bsdf &bsdf = loaded.scene.materials.at(0).front;
    EXPECT_EQ(bsdf.exponent.texture, 0);
    EXPECT_FLOAT_EQ(bsdf.alpha_u.value, std::sqrt(2 / 1e4f));
    EXPECT_FLOAT_EQ(bsdf.alpha_v.value, std::sqrt(2 / 1e4f));
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
                HasSubstr("unknown filter_type \"cubic\" (known: bilinear, nearest, trilinear, ewa, anisotropic)"));
    EXPECT_THAT(error(bitmap_text("a.png", "<string name=\"wrap_mode\" value=\"two\"/>")),
                HasSubstr("unknown wrap_mode \"two\" (known: repeat, mirror, clamp, zero, one, black, white)"));
    EXPECT_THAT(error("<texture type=\"bitmep\"/>"), HasSubstr("did you mean \"bitmap\"?"));
    EXPECT_THAT(error("<texture type=\"scale\"/>"), HasSubstr("scale needs one nested texture, not 0"));
    EXPECT_THAT(error(bitmap_text("a.png"), "eta", "conductor"), HasSubstr("\"eta\" cannot be a texture"));
    EXPECT_THAT(error("<texture type=\"bitmap\"/>"), HasSubstr("bitmap needs a filename"));
}

TEST_F(TexturePlugin, ChannelsXYZAreNoGray) {
    const float values[] = {0.25f, 0.5f, 0.75f, 1};
    write_values("xyz.exr", 1, 1, 3, OIIO::TypeDesc::FLOAT, values, {"X", "Y", "Z"});
    EXPECT_THAT(error(bitmap_text("xyz.exr")), AllOf(HasSubstr("xyz.exr"), HasSubstr("save colours as R, G and B")));
    const Texture raw = texture(bitmap_text("xyz.exr", "<boolean name=\"raw\" value=\"true\"/>"));
    EXPECT_EQ(texel(raw, 0, 0), (std::array<double, 3>{0.25, 0.5, 0.75}));
    write_values("yz.exr", 1, 1, 2, OIIO::TypeDesc::FLOAT, values, {"Y", "Z"});
    EXPECT_EQ(texel(texture(bitmap_text("yz.exr")), 0, 0), (std::array<double, 3>{0.25, 0.25, 0.25}));
}

// Of 32 bits in OpenEXR: no shares of the largest.
TEST_F(TexturePlugin, TwoChannelsAreNoGrayUnlessOneIsAlpha) {
    const float values[] = {0.25f, 0.5f, 0.75f};
    write_values("rg.exr", 1, 1, 2, OIIO::TypeDesc::FLOAT, values, {"R", "G"});
    EXPECT_THAT(error(bitmap_text("rg.exr")), AllOf(HasSubstr("rg.exr"), HasSubstr("its channels are R, G: gray")));
    EXPECT_EQ(texel(texture(bitmap_text("rg.exr", "<string name=\"channel\" value=\"g\"/>"), "0.6.0"), 0, 0),
              (std::array<double, 3>{0.5, 0.5, 0.5}));
    write_values("rga.exr", 1, 1, 3, OIIO::TypeDesc::FLOAT, values, {"R", "G", "A"});
    EXPECT_THAT(error(bitmap_text("rga.exr")), HasSubstr("its channels are R, G, A: gray"));
    write_values("ra.exr", 1, 1, 2, OIIO::TypeDesc::FLOAT, values, {"R", "A"});
    EXPECT_EQ(texel(texture(bitmap_text("ra.exr")), 0, 0), (std::array<double, 3>{0.25, 0.25, 0.25}));
}

TEST_F(TexturePlugin, WholeNumbersOfOpenExrAreWhatTheySay) {
    write<std::uint32_t>("u.exr", 3, OIIO::TypeDesc::UINT32, 16);
    const Texture found = load(bitmap_text("u.exr")).scene.textures.at(0);
    for (std::uint32_t i = 0; i < 12; ++i)
        EXPECT_NEAR(found.bitmap->channel(i / 3 % 2, i / 6, int(i % 3)), i, 1e-6 * i) << i;
}

TEST_F(TexturePlugin, RadianceFilesOfOtherOrdersAreRefused) {
    const std::string begin = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", texels(16, '\x80');
    for (const char *order : {"+Y 2 +X 2", "-Y 2 -X 2", "+X 2 -Y 2"}) {
        folder_.write("a.hdr", begin + order + "\n" + texels);
        EXPECT_THAT(error(bitmap_text("a.hdr")), HasSubstr("do not run from the top left")) << order;
        EXPECT_THROW(read_image((folder_.path() / "a.hdr").string()), Error) << order;
    }
    folder_.write("a.hdr", begin + "-Y 2 +X 2\n" + texels);
    EXPECT_EQ(error(bitmap_text("a.hdr")), "");
}

// Whatever a format has to say of it: what an environment is, and `compare` reads.
TEST_F(TexturePlugin, EightBitsAreSrgbInAllFormats) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    const Image png = read_image((folder_.path() / "a.png").string());
    for (const std::string name : {"a.bmp", "a.tga", "a.ppm", "a.tif"}) {
        write<std::uint8_t>(name, 3, OIIO::TypeDesc::UINT8, 255);
        const Image same = read_image((folder_.path() / name).string());
        for (const char *channel : {"R", "G", "B"})
            EXPECT_EQ(same.find(channel)->values, png.find(channel)->values) << name << " " << channel;
    }
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

/// A header may declare any number of pixels in few blocks.
TEST_F(TexturePlugin, BombsOfOpenExrAreRefused) {
    const std::vector<float> white(4, 1);
    const std::string path = (folder_.path() / "bomb.exr").string();
    const auto output = OIIO::ImageOutput::create(path);
    OIIO::ImageSpec spec(2, 2, 1, OIIO::TypeDesc::FLOAT);
    spec.attribute("compression", "dwab"); // 256 lines a block
    ASSERT_TRUE(output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, white.data()) &&
                output->close());
    std::stringstream bytes;
    bytes << std::ifstream(path, std::ios::binary).rdbuf();
    std::string text = bytes.str();
    const std::size_t box = text.find("dataWindow") + sizeof "dataWindow" + sizeof "box2i" + 4;
    text.replace(box + 8, 8, std::string("\0\0\2\0\xff\3\0\0", 8)); // 131073 x 1024
    folder_.write("bomb.exr", text);
    EXPECT_THAT(error(bitmap_text("bomb.exr")), HasSubstr("its pixels would take 512 MiB, far more than a file of its "
                                                          "size holds; --limits 10"));
}

/// What OpenImageIO would take for parameters.
TEST_F(TexturePlugin, NamesMayHaveQuestionMarks) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    std::filesystem::rename(folder_.path() / "a.png", folder_.path() / "a?b.png");
    EXPECT_NEAR(texel(texture(bitmap_text("a?b.png")), 1, 0)[2], linear(79 / 255.0), 1e-9);
    folder_.write("c?.png", "nothing");
    EXPECT_THAT(error(bitmap_text("c?.png")), HasSubstr("of a name with a question mark the formats are openexr"));
}

/// Their pictures are not decoded, nor do they stay; what is wrong with them else is told.
TEST_F(TexturePlugin, OfBsdfsThatNobodyUsesAreNotRead) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    folder_.write("bad.png", "\x89PNG\r\n\x1a\nnothing");
    const auto bsdf = [](const std::string &picture, const std::string &inside = "") {
        std::string text = bitmap_text(picture);
        return "<bsdf type=\"diffuse\">" + text.insert(text.find(' '), " name=\"reflectance\"") + inside + "</bsdf>\n";
    };
    const std::string bump = bitmap_text("bad.png", "<string name=\"wrapMode\" value=\"black\"/>");
    const LoadedScene loaded = load_scene(folder_.write(
        "scene.xml",
        scene_around(bsdf("bad.png") + bsdf("gone.png") + bsdf("bad.png", "<float name=\"no\" value=\"1\"/>") +
                         "<bsdf type=\"bumpmap\"><texture type=\"scale\"><float name=\"scale\" value=\"9\"/>" + bump +
                         "</texture><bsdf type=\"blendbsdf\">" + bsdf("bad.png") + bsdf("a.png") +
                         "<float name=\"weight\" value=\"0.5\"/></bsdf></bsdf>\n<shape type=\"cube\">" + bsdf("a.png") +
                         "</shape>",
                     "0.6.0", constant_light)));
    EXPECT_THAT(loaded.warnings,
                ElementsAre(HasSubstr("scene.xml:4: unused BSDF: "), HasSubstr("unknown parameter \"no\"")));
    EXPECT_THAT(loaded.warnings.at(0), HasSubstr("cannot find the file \"gone.png\""));
    ASSERT_EQ(loaded.scene.textures.size(), 1u);
    EXPECT_EQ(loaded.scene.textures[0].bitmap->width, 2u);
    EXPECT_THAT(loaded.scene.blends, IsEmpty());
    EXPECT_THAT(loaded.scene.blended, IsEmpty());
}

/// To go over 16 million texels takes 16 ms.
TEST_F(TexturePlugin, RangesOfOnePictureAreFoundOnce) {
    const std::vector<std::uint8_t> black(std::size_t(4096) * 4096);
    write_values("a.png", 4096, 4096, 1, OIIO::TypeDesc::UINT8, black.data());
    const std::string texture = "<texture type=\"bitmap\"><string name=\"filename\" value=\"a.png\"/></texture>";
    std::string shapes;
    for (int i = 0; i < 400; ++i) {
        std::string in_it = texture;
        shapes += "<shape type=\"cube\"><bsdf type=\"roughconductor\">" +
                  in_it.insert(in_it.find(' '), " name=\"alpha\"") +
                  "<texture type=\"scale\" name=\"specular_reflectance\"><float name=\"scale\" value=\"0." +
                  std::to_string(1000 + i) + "\"/>" + texture + "</texture></bsdf></shape>";
    }
    const std::clock_t start = std::clock();
    EXPECT_EQ(load_scene(folder_.write("scene.xml", scene_around(shapes))).scene.textures.size(), 800u);
    EXPECT_LT(double(std::clock() - start) / CLOCKS_PER_SEC, 20);
}

/// Environments take 8 and 16 bits as textures do, whatever the file says of them.
TEST_F(TexturePlugin, EnvironmentsAreSrgbUnlessTheirGammaIs1) {
    const auto sky = [&](const std::string &inside) {
        return load_scene(folder_.write(
            "scene.xml", scene_around("<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.png\"/>" +
                                          inside + "</emitter>",
                                      "0.6.0")));
    };
    const auto radiance = [](const LoadedScene &loaded) {
        return loaded.scene.emitters.at(0).map->integral.g / (4 * 3.14159265358979);
    };
    const auto gamma = [](const std::string &value) { return "<float name=\"gamma\" value=\"" + value + "\"/>"; };
    const std::string path = (folder_.path() / "sky.png").string();
    for (const std::string space : {"", "linear", "Gamma2.2"})
        for (const OIIO::TypeDesc type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16}) {
            OIIO::ImageSpec spec(1, 1, 3, type);
            if (!space.empty())
                spec.attribute("oiio:ColorSpace", space);
            const float half[] = {0.5f, 0.5f, 0.5f};
            const auto output = OIIO::ImageOutput::create(path);
            ASSERT_TRUE(output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, half) &&
                        output->close());
            const double stored = read_bitmap(*OpenFile::open(path), {true}).bitmap.channel(0, 0, 0);
            EXPECT_NEAR(stored, 0.5, 0.01);
            // As a map is kept, to 11 bits.
            EXPECT_NEAR(radiance(sky("")), linear(stored), 1e-3 * stored) << space;
            EXPECT_NEAR(radiance(sky(gamma("-1"))), linear(stored), 1e-3 * stored) << space;
            EXPECT_NEAR(radiance(sky(gamma("1"))), stored, 1e-3 * stored) << space;
            EXPECT_THAT(sky(gamma("1")).warnings, IsEmpty());
            EXPECT_THAT(sky(gamma("2.2")).warnings, ElementsAre(HasSubstr("read as the curve of sRGB")));
        }
}

TEST_F(TexturePlugin, WrapsOtherwiseAlongV) {
    write<std::uint8_t>("a.png", 3, OIIO::TypeDesc::UINT8, 255);
    const Texture found = texture(bitmap_text("a.png", "<string name=\"wrapModeU\" value=\"clamp\"/>"
                                                       "<string name=\"wrapModeV\" value=\"mirror\"/>"),
                                  "0.6.0");
    EXPECT_EQ(found.wrap, Texture::Wrap::clamp);
    EXPECT_EQ(found.wrap_along_v(), Texture::Wrap::mirror);
    const Texture alike = texture(bitmap_text("a.png", "<string name=\"wrapMode\" value=\"clamp\"/>"), "0.6.0");
    EXPECT_EQ(alike.wrap_along_v(), Texture::Wrap::clamp);
    EXPECT_THAT(error(bitmap_text("a.png", "<string name=\"wrapModeV\" value=\"two\"/>")),
                HasSubstr("unknown wrap_mode_v \"two\""));
}

// Against texels taken one by one, each from the picture or from what is around it.
TEST_F(TexturePlugin, HasZeroOrOneAround) {
    const std::uint8_t bytes[] = {10, 200, 60, 90, 250, 130};
    write_values("bytes.png", 3, 2, 1, OIIO::TypeDesc::UINT8, bytes);
    const std::uint16_t halves[] = {0x3800, 0x3400, 0x3a00, 0x2c00, 0x3c00, 0x3000};
    write_values("halves.exr", 3, 2, 1, OIIO::TypeDesc::HALF, halves);
    const float reals[] = {0.1f, 0.9f, 0.3f, 0.7f, 0.2f, 0.6f};
    write_values("reals.exr", 3, 2, 1, OIIO::TypeDesc::FLOAT, reals);
    struct Around {
        const char *along_u, *along_v;
        std::optional<double> u, v; ///< nothing: repeated
    };
    const std::string turned = "<float name=\"uscale\" value=\"2\"/><float name=\"uoffset\" value=\"-0.5\"/>"
                               "<float name=\"vscale\" value=\"-1.5\"/>";
    for (const char *file : {"bytes.png", "halves.exr", "reals.exr"})
        for (const Around &around : {Around{"zero", "zero", 0.0, 0.0}, Around{"one", "black", 1.0, 0.0},
                                     Around{"repeat", "white", {}, 1.0}, Around{"zero", "repeat", 0.0, {}}})
            for (const char *filter : {"nearest", "bilinear"}) {
                const std::string plain = fmt::format("<string name=\"filterType\" value=\"{}\"/>", filter);
                const Texture inner = texture(bitmap_text(file, plain), "0.6.0");
                const Texture found =
                    texture(bitmap_text(file, plain + turned +
                                                  fmt::format("<string name=\"wrapModeU\" value=\"{}\"/>"
                                                              "<string name=\"wrapModeV\" value=\"{}\"/>",
                                                              around.along_u, around.along_v)),
                            "0.6.0");
                const auto texel_at = [&](int x, int y) {
                    const bool is_beside = x < 0 || x > 2, is_beyond = y < 0 || y > 1;
                    if (is_beside && around.u)
                        return *around.u;
                    if (is_beyond && around.v)
                        return *around.v;
                    return texture_value(inner, ((x % 3 + 3) % 3 + 0.5) / 3, ((y % 2 + 2) % 2 + 0.5) / 2)[0];
                };
                for (double u = -1.03; u < 2; u += 0.11)
                    for (double v = -1.01; v < 2; v += 0.13) {
                        const double x = (2 * u - 0.5) * 3, y = -1.5 * v * 2;
                        double expected = texel_at(int(std::floor(x)), int(std::floor(y)));
                        if (!found.is_nearest) {
                            const double left = std::floor(x - 0.5), top = std::floor(y - 0.5);
                            const double right = x - 0.5 - left, down = y - 0.5 - top;
                            const auto row = [&](int at) {
                                return (1 - right) * texel_at(int(left), at) + right * texel_at(int(left) + 1, at);
                            };
                            expected = (1 - down) * row(int(top)) + down * row(int(top) + 1);
                        }
                        ASSERT_NEAR(texture_value(found, u, v)[0], expected, 1e-5)
                            << file << " " << around.along_u << " " << around.along_v << " " << filter << " at " << u
                            << ", " << v;
                    }
            }
}

TEST_F(TexturePlugin, BordersAreMadeOnce) {
    const std::vector<std::uint8_t> bytes(64 * 64, 100);
    write_values("a.png", 64, 64, 1, OIIO::TypeDesc::UINT8, bytes.data());
    const auto shape = [](const std::string &wrap) {
        std::string texture = bitmap_text("a.png", "<string name=\"wrapMode\" value=\"" + wrap + "\"/>");
        texture.insert(texture.find("type="), "name=\"reflectance\" ");
        return "<shape type=\"cube\"><bsdf type=\"diffuse\">" + texture + "</bsdf></shape>";
    };
    const std::string path = folder_.write(
        "scene.xml", scene_around(shape("zero") + shape("black") + shape("one"), "0.6.0", constant_light));
    const LoadedScene loaded = load_scene(path);
    const std::vector<Texture> &textures = loaded.scene.textures;
    ASSERT_EQ(textures.size(), 3u);
    EXPECT_EQ(textures[0].bitmap, textures[1].bitmap);
    EXPECT_NE(textures[0].bitmap, textures[2].bitmap);
}

class MapPlugin : public TexturePlugin {
  protected:
    void SetUp() override { write<float>("n.exr", 3, OIIO::TypeDesc::FLOAT, 1); }
    LoadedScene load_bsdf(const std::string &bsdf, const std::string &version = "3.0.0") {
        return load_scene(folder_.write("scene.xml", around(bsdf, version)));
    }
    std::string error_of_bsdf(const std::string &bsdf) {
        return error_of(folder_.write("scene.xml", around(bsdf, "3.0.0")));
    }
    /// The one material of a file without warnings.
    Material material(const std::string &bsdf, const std::string &version = "3.0.0") {
        const LoadedScene loaded = load_bsdf(bsdf, version);
        EXPECT_THAT(loaded.warnings, IsEmpty());
        EXPECT_EQ(loaded.scene.textures.size(), 1u);
        return loaded.scene.materials.at(0);
    }
    static std::string around(const std::string &bsdf, const std::string &version) {
        return scene_around(
            "<texture type=\"bitmap\" id=\"map\"><string name=\"filename\" value=\"n.exr\"/></texture>" +
                std::string("<shape type=\"cube\">") + bsdf + "</shape><emitter type=\"constant\"/>",
            version, "");
    }
};

const std::string map_text = "<ref id=\"map\"/>", wood = "<bsdf type=\"diffuse\"/>";

TEST_F(MapPlugin, Defaults) {
    const Bsdf normal =
        material("<bsdf type=\"normalmap\"><ref name=\"normalmap\" id=\"map\"/>" + wood + "</bsdf>").front;
    EXPECT_EQ(normal.kind, BsdfKind::diffuse);
    EXPECT_EQ(normal.map.kind, NormalTexture::Kind::normal);
    EXPECT_EQ(normal.map.texture, 0);
    EXPECT_TRUE(normal.map.turns_over);
    EXPECT_TRUE(normal.map.shadows);
    EXPECT_FALSE(normal.map.is_outside);
    const Bsdf bump = material("<bsdf type=\"bumpmap\">" + map_text + wood + "</bsdf>").front;
    EXPECT_EQ(bump.map.kind, NormalTexture::Kind::bump);
    EXPECT_EQ(bump.map.scale, 1);
    EXPECT_TRUE(bump.map.turns_over);
    EXPECT_TRUE(bump.map.shadows);
}

TEST_F(MapPlugin, Parameters) {
    const std::string both = "<boolean name=\"flip_invalid_normals\" value=\"false\"/>"
                             "<boolean name=\"use_shadowing_function\" value=\"false\"/>";
    const Bsdf bump =
        material("<bsdf type=\"bumpmap\">" + map_text + wood + both + "<float name=\"scale\" value=\"-2.5\"/></bsdf>")
            .front;
    EXPECT_EQ(bump.map.scale, -2.5f);
    EXPECT_FALSE(bump.map.turns_over);
    EXPECT_FALSE(bump.map.shadows);
    const Bsdf normal = material("<bsdf type=\"normalmap\">" + map_text + wood + both + "</bsdf>").front;
    EXPECT_FALSE(normal.map.turns_over);
    EXPECT_FALSE(normal.map.shadows);
}

/// Values of a normal map and heights are no parameters to be clamped.
TEST_F(MapPlugin, TexturesKeepTheirValues) {
    const LoadedScene loaded = load_bsdf("<bsdf type=\"bumpmap\">" + map_text + wood + "</bsdf>");
    EXPECT_LT(loaded.scene.textures.at(0).lowest, -1e30f);
    EXPECT_GT(loaded.scene.textures.at(0).highest, 1e30f);
}

TEST_F(MapPlugin, OfOldFiles) {
    for (const char *type : {"bumpmap", "normalmap"}) {
        const Bsdf bsdf = material("<bsdf type=\"" + std::string(type) +
                                       "\"><texture type=\"scale\"><float name=\"scale\" value=\"3\"/>" + map_text +
                                       "</texture>" + wood + "</bsdf>",
                                   "0.6.0")
                              .front;
        EXPECT_FALSE(bsdf.map.turns_over) << type;
        EXPECT_FALSE(bsdf.map.shadows) << type;
        EXPECT_EQ(bsdf.map.scale, 1) << type;
    }
    const LoadedScene scaled =
        load_bsdf("<bsdf type=\"bumpmap\"><texture type=\"scale\"><float name=\"scale\" value=\"3\"/>" + map_text +
                      "</texture>" + wood + "</bsdf>",
                  "0.5.0");
    EXPECT_EQ(scaled.scene.textures.at(0).scale[0], 3);
}

TEST_F(MapPlugin, WithinOthersAndAround) {
    const std::string bump = "<bsdf type=\"bumpmap\">" + map_text, end = "</bsdf>";
    const Material inside = material("<bsdf type=\"twosided\">" + bump + wood + end + end);
    EXPECT_TRUE(inside.two_sided);
    EXPECT_FALSE(inside.front.map.is_outside);
    EXPECT_EQ(inside.front, inside.back);
    const Material outside = material(bump + "<bsdf type=\"twosided\">" + wood + end + end);
    EXPECT_TRUE(outside.two_sided);
    EXPECT_TRUE(outside.front.map.is_outside);
    EXPECT_EQ(outside.front, outside.back);
    const Material faces = material("<bsdf type=\"twosided\">" + bump + wood + end + wood + end);
    EXPECT_EQ(faces.front.map.kind, NormalTexture::Kind::bump);
    EXPECT_EQ(faces.back.map.kind, NormalTexture::Kind::none);
    const Material holes = material(bump + "<bsdf type=\"mask\">" + wood + end + end);
    EXPECT_EQ(holes.opacity, 0.5f);
    EXPECT_EQ(holes.front.map.kind, NormalTexture::Kind::bump);
    // Parts of blends have it each; nothing to turn where nothing is.
    const LoadedScene blend =
        load_bsdf(bump + "<bsdf type=\"blendbsdf\">" + wood + "<bsdf type=\"null\"/>" + end + end);
    const Blend &parts = blend.scene.blends.at(std::size_t(blend.scene.materials.at(0).front.blend));
    EXPECT_EQ(blend.scene.blended.at(parts.first).map.kind, NormalTexture::Kind::bump);
    EXPECT_EQ(blend.scene.blended.at(parts.second).map.kind, NormalTexture::Kind::none);
    // A BSDF referenced without its wrapper has no map.
    EXPECT_EQ(material(bump + "<bsdf type=\"diffuse\" id=\"plain\"/>" + end + "</shape><shape type=\"cube\">" +
                       "<ref id=\"plain\"/>")
                  .front.map.kind,
              NormalTexture::Kind::bump);
    EXPECT_EQ(load_bsdf(bump + "<bsdf type=\"diffuse\" id=\"plain\"/>" + end + "</shape><shape type=\"cube\">" +
                        "<ref id=\"plain\"/>")
                  .scene.materials.at(1)
                  .front.map.kind,
              NormalTexture::Kind::none);
}

/// A hill becomes a hollow; a reflectance stays at least 0.
TEST_F(MapPlugin, AScaleBelow0TurnsABumpOver) {
    const std::string scale = "<texture type=\"scale\"><float name=\"scale\" value=\"-0.25\"/>";
    const LoadedScene bump = load_bsdf("<bsdf type=\"bumpmap\">" + scale + map_text + "</texture>" + wood + "</bsdf>");
    EXPECT_THAT(bump.warnings, IsEmpty());
    const Texture &hollow = bump.scene.textures.at(std::size_t(bump.scene.materials.at(0).front.map.texture));
    Texture hill = hollow;
    hill.scale = {1, 1, 1};
    EXPECT_NEAR(texture_value(hollow, 0.3, 0.3)[0], -0.25 * texture_value(hill, 0.3, 0.3)[0], 1e-6);
    EXPECT_LT(texture_value(hollow, 0.3, 0.3)[0], 0);
    const LoadedScene color =
        load_bsdf("<bsdf type=\"diffuse\"><texture name=\"reflectance\" type=\"scale\"><float name=\"scale\" "
                  "value=\"-0.25\"/><texture type=\"checkerboard\"/></texture></bsdf>");
    EXPECT_THAT(color.warnings, ElementsAre(HasSubstr("clamped to 0")));
    EXPECT_EQ(color.scene.materials.at(0).front.reflectance.r, 0);
}

TEST_F(MapPlugin, WhatIsWrong) {
    for (const std::string type : {"bumpmap", "normalmap"}) {
        const std::string begin = "<bsdf type=\"" + type + "\">", end = "</bsdf>";
        EXPECT_THAT(error_of_bsdf(begin + wood + end), HasSubstr(type + " needs one nested texture, not 0"));
        EXPECT_THAT(error_of_bsdf(begin + map_text + map_text + wood + end), HasSubstr("one nested texture, not 2"));
        EXPECT_THAT(error_of_bsdf(begin + map_text + end), HasSubstr(type + " needs one nested BSDF, not 0"));
        EXPECT_THAT(error_of_bsdf(begin + map_text + begin + map_text + wood + end + end),
                    HasSubstr("around another one is not supported"));
    }
    EXPECT_THAT(load_bsdf("<bsdf type=\"bumpmap\"><texture type=\"checkerboard\"/>" + wood + "</bsdf>").warnings,
                ElementsAre(HasSubstr("has no slope")));
    EXPECT_THAT(error_of_bsdf("<bsdf type=\"bumpmap\"><texture type=\"mesh_attribute\"><string name=\"name\" "
                              "value=\"vertex_a\"/></texture>" +
                              wood + "</bsdf>"),
                HasSubstr("a bump map cannot be a mesh attribute"));
    write<std::uint8_t>("n.png", 3, OIIO::TypeDesc::UINT8, 255);
    EXPECT_THAT(load_bsdf("<bsdf type=\"normalmap\">" + bitmap_text("n.png") + wood + "</bsdf>").warnings,
                ElementsAre(HasSubstr("decoded from sRGB")));
}

} // namespace
} // namespace gradus
