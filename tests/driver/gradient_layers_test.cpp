// Where `gradus solve` finds its images: files of their own, layers, other names, and what does not fit.
#include "driver/gradient_layers.h"
#include "runtime/error.h"
#include "tests/driver/gradient_images.h"

#include <OpenImageIO/imageio.h>
#include <gmock/gmock.h>

namespace gradus {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class GradientLayers : public GradientImagesTest {
  protected:
    GradientSources three_files() const {
        GradientSources sources;
        sources.files = {{GradientLayer::primal, write_colours("p.exr", 100)},
                         {GradientLayer::dx, write_colours("dx.exr", 200)},
                         {GradientLayer::dy, write_colours("dy.exr", 300)}};
        return sources;
    }
    GradientSources layered(const std::string &path) const {
        GradientSources sources;
        sources.layered = path;
        return sources;
    }
    /// The planes of a layer hold what colours(..., first) of 3 x 2 pixels has.
    void expect_colours(const GradientImages &images, GradientLayer layer, float first) const {
        ASSERT_NE(images.find(layer), nullptr) << layer_name(layer);
        std::vector<float> expected;
        for (const float start : {first, first + 10, first + 20})
            for (int i = 0; i < 6; ++i)
                expected.push_back(start + float(i));
        EXPECT_EQ(images.planes.at(layer), expected) << layer_name(layer);
    }
    /// Each layer's red begins at a hundred more than that of the layer before. Halves and features are not there.
    void expect_all_layers(const GradientImages &images) const {
        float first = 100;
        for (const GradientLayer layer : gradient_layers) {
            if (is_of_half(layer) || is_feature(layer))
                continue;
            expect_colours(images, layer, first);
            first += 100;
        }
    }
    void expect_error(const GradientSources &sources, ExitCode code, const ::testing::Matcher<std::string> &text) {
        try {
            read_gradient_images(sources);
            ADD_FAILURE() << "no error";
        } catch (const Error &error) {
            EXPECT_EQ(error.code, code);
            EXPECT_THAT(std::string(error.what()), text);
        }
    }
};

TEST_F(GradientLayers, ThreeFiles) {
    const GradientImages images = read_gradient_images(three_files());
    EXPECT_EQ(images.width, 3u);
    EXPECT_EQ(images.height, 2u);
    EXPECT_THAT(images.channels, ElementsAre("R", "G", "B"));
    EXPECT_EQ(images.planes.size(), 3u);
    expect_colours(images, GradientLayer::primal, 100);
    expect_colours(images, GradientLayer::dx, 200);
    expect_colours(images, GradientLayer::dy, 300);
    EXPECT_EQ(images.find(GradientLayer::direct), nullptr);
}

TEST_F(GradientLayers, OfDifferentPlacesHaveNothingInCommon) {
    GradientSources sources = three_files();
    Image image = counting_image(3, 2, colours("", 200));
    image.origin = PixelPlace{-3, 5};
    sources.files[GradientLayer::dx] = write("apart.exr", image);
    expect_error(sources, ExitCode::image,
                 AllOf(HasSubstr("places differ: "), HasSubstr("p.exr' is at pixel (0, 0) of its frame, "),
                       HasSubstr("apart.exr' is at pixel (-3, 5) of its frame")));
    for (const GradientLayer layer : {GradientLayer::primal, GradientLayer::dx, GradientLayer::dy})
        sources.files[layer] = sources.files[GradientLayer::dx];
    EXPECT_EQ(read_gradient_images(sources).origin, image.origin);
    image.origin = {};
    image.metadata["crop"] = "6,0,3,2";
    sources = three_files();
    sources.files[GradientLayer::dy] = write("crop.exr", image);
    image.metadata["crop"] = "3,0,3,2";
    sources.files[GradientLayer::primal] = write("beside.exr", image);
    expect_error(sources, ExitCode::image, HasSubstr("crop.exr' is the crop 6,0,3,2 of an image"));
}

TEST_F(GradientLayers, AlphaDepthAndTheOrderOfChannelsDoNotMatter) {
    GradientSources sources = three_files();
    sources.files[GradientLayer::dx] =
        write("more.exr", counting_image(3, 2, {{"Z", 1}, {"B", 220}, {"A", 2}, {"R", 200}, {"G", 210}}));
    expect_colours(read_gradient_images(sources), GradientLayer::dx, 200);
    sources.files[GradientLayer::dx] = write("small.exr", counting_image(3, 2, {{"b", 220}, {"r", 200}, {"g", 210}}));
    expect_colours(read_gradient_images(sources), GradientLayer::dx, 200);
}

TEST_F(GradientLayers, OneFileWithLayers) {
    const std::string path = write("all.exr", counting_image(3, 2,
                                                             layers({{"", 1},
                                                                     {"albedo", 2},
                                                                     {"primal", 100},
                                                                     {"dx", 200},
                                                                     {"dy", 300},
                                                                     {"direct", 400},
                                                                     {"primal_variance", 500},
                                                                     {"dx_variance", 600},
                                                                     {"dy_variance", 700}})));
    GradientSources sources = layered(path);
    EXPECT_EQ(read_gradient_images(sources).planes.size(), 4u) << "variances are read only where they are asked for";
    sources.variances = true;
    const GradientImages images = read_gradient_images(sources);
    expect_all_layers(images);
}

TEST_F(GradientLayers, HalvesAreReadWhereTheyAreAskedFor) {
    const std::string path = write("halves.exr", counting_image(3, 2,
                                                                layers({{"primal_even", 100},
                                                                        {"dx_even", 200},
                                                                        {"dy_even", 300},
                                                                        {"primal_even_variance", 400},
                                                                        {"dx_even_variance", 500},
                                                                        {"dy_even_variance", 600},
                                                                        {"primal_odd", 700},
                                                                        {"dx_odd", 800},
                                                                        {"dy_odd", 900},
                                                                        {"primal_odd_variance", 1000},
                                                                        {"dx_odd_variance", 1100},
                                                                        {"dy_odd_variance", 1200}})));
    GradientSources sources = layered(path);
    sources.halves = true;
    const GradientImages images = read_gradient_images(sources);
    float first = 100;
    for (const auto &half : half_layers)
        for (const GradientLayer layer : half) {
            expect_colours(images, layer, first);
            first += 100;
        }
    sources.halves = false;
    expect_error(sources, ExitCode::image, HasSubstr("primal"));
}

TEST_F(GradientLayers, NamesOfOtherRenderersInAnyCase) {
    const std::string path = write("other.exr", counting_image(3, 2,
                                                               layers({{"Throughput", 100},
                                                                       {"gradientX", 200},
                                                                       {"GRADIENT_Y", 300},
                                                                       {"very_direct", 400},
                                                                       {"Throughput_Variance", 500},
                                                                       {"variance.dx", 600},
                                                                       {"variance_dy", 700}})));
    GradientSources sources = layered(path);
    sources.variances = true;
    const GradientImages images = read_gradient_images(sources);
    expect_all_layers(images);
}

TEST_F(GradientLayers, OurNamesGoBeforeOthers) {
    const GradientImages images = read_gradient_images(layered(
        write("both.exr",
              counting_image(
                  3, 2, layers({{"GradientX", 1}, {"Throughput", 2}, {"dx", 200}, {"primal", 100}, {"dy", 300}})))));
    expect_colours(images, GradientLayer::primal, 100);
    expect_colours(images, GradientLayer::dx, 200);
}

TEST_F(GradientLayers, NamesThatAreGivenGoBeforeAll) {
    GradientSources sources = layered(write(
        "own.exr",
        counting_image(3, 2, layers({{"", 100}, {"primal", 1}, {"right.hand", 200}, {"dy", 300}, {"lamp", 400}}))));
    sources.names = {{GradientLayer::primal, ""}, {GradientLayer::dx, "right.hand"}, {GradientLayer::direct, "lamp"}};
    const GradientImages images = read_gradient_images(sources);
    expect_colours(images, GradientLayer::primal, 100);
    expect_colours(images, GradientLayer::dx, 200);
    expect_colours(images, GradientLayer::dy, 300);
    expect_colours(images, GradientLayer::direct, 400);
    sources.names[GradientLayer::direct] = "lamps";
    expect_error(sources, ExitCode::image, HasSubstr("no layer \"lamps\" for direct"));
}

TEST_F(GradientLayers, FilesOfTheirOwnGoBeforeLayers) {
    GradientSources sources = layered(write_layers("all.exr"));
    sources.files[GradientLayer::dx] = write_colours("dx.exr", 7);
    sources.files[GradientLayer::direct] = write_colours("direct.exr", 400);
    const GradientImages images = read_gradient_images(sources);
    expect_colours(images, GradientLayer::primal, 100);
    expect_colours(images, GradientLayer::dx, 7);
    expect_colours(images, GradientLayer::direct, 400);
}

TEST_F(GradientLayers, AFileOfItsOwnMayHoldTheImageAsALayer) {
    GradientSources sources = three_files();
    const std::string path = write("all.exr", counting_image(3, 2, layers({{"", 1}, {"dx", 200}, {"left", 300}})));
    sources.files[GradientLayer::dx] = sources.files[GradientLayer::dy] = path;
    sources.names[GradientLayer::dy] = "left";
    const GradientImages images = read_gradient_images(sources);
    expect_colours(images, GradientLayer::dx, 200);
    expect_colours(images, GradientLayer::dy, 300);
}

TEST_F(GradientLayers, APartOfAFileIsALayer) {
    const std::string path = at("parts.exr");
    const std::vector<std::string> names{"primal", "dx", "dy"};
    std::vector<OIIO::ImageSpec> specs(3, OIIO::ImageSpec(3, 2, 3, OIIO::TypeDesc::FLOAT));
    for (std::size_t i = 0; i < specs.size(); ++i)
        specs[i].attribute("oiio:subimagename", names[i]);
    const auto output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output->open(path, 3, specs.data()));
    for (std::size_t part = 0; part < specs.size(); ++part) {
        if (part > 0) {
            ASSERT_TRUE(output->open(path, specs[part], OIIO::ImageOutput::AppendSubimage));
        }
        std::vector<float> interleaved;
        for (int i = 0; i < 6; ++i)
            for (int c = 0; c < 3; ++c)
                interleaved.push_back(float(100 * (part + 1) + 10 * c + i));
        ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, interleaved.data()));
    }
    ASSERT_TRUE(output->close());
    const GradientImages images = read_gradient_images(layered(path));
    expect_colours(images, GradientLayer::primal, 100);
    expect_colours(images, GradientLayer::dx, 200);
    expect_colours(images, GradientLayer::dy, 300);
}

/// As an image of ours with --aov: its R, G and B are neither variances nor differences, its layer `variance` is that
/// of primal and direct image together.
TEST_F(GradientLayers, AFileWithLayersOfOtherNamesIsNoVarianceAndNoDifference) {
    const std::string rendered =
        write("rendered.exr", counting_image(3, 2, layers({{"", 1}, {"albedo", 2}, {"variance", 3}})));
    GradientSources sources = layered(write_layers("all.exr"));
    sources.variances = true;
    for (const GradientLayer layer :
         {GradientLayer::primal_variance, GradientLayer::dx_variance, GradientLayer::dy_variance})
        sources.files[layer] = write_colours("plain.exr", 500);
    expect_colours(read_gradient_images(sources), GradientLayer::primal_variance, 500);
    sources.files[GradientLayer::primal_variance] = rendered;
    expect_error(sources, ExitCode::image,
                 AllOf(HasSubstr("rendered.exr' has no layer for primal_variance"),
                       HasSubstr("Name it with --layer primal_variance=NAME")));
    sources.names[GradientLayer::primal_variance] = ""; // and so it may be asked for
    expect_colours(read_gradient_images(sources), GradientLayer::primal_variance, 1);
    sources = three_files();
    sources.files[GradientLayer::primal] = sources.files[GradientLayer::direct] = rendered;
    expect_colours(read_gradient_images(sources), GradientLayer::primal, 1);
    sources.files[GradientLayer::dx] = rendered;
    expect_error(sources, ExitCode::image, HasSubstr("rendered.exr' has no layer for dx"));
}

TEST_F(GradientLayers, GreyFilesHaveOneChannel) {
    GradientSources sources = layered(
        write("grey.exr", counting_image(3, 2, {{"primal.Y", 100}, {"primal.A", 1}, {"dx.Y", 200}, {"dy.Y", 300}})));
    const GradientImages images = read_gradient_images(sources);
    EXPECT_THAT(images.channels, ElementsAre("Y"));
    EXPECT_THAT(images.planes.at(GradientLayer::dy), ElementsAre(300, 301, 302, 303, 304, 305));
}

TEST_F(GradientLayers, PortableFloatMapsFromTheBottomUp) {
    const float rows[] = {3, 4, 1, 2};
    const std::string bytes(reinterpret_cast<const char *>(rows), sizeof rows);
    GradientSources sources;
    for (const GradientLayer layer : {GradientLayer::primal, GradientLayer::dx, GradientLayer::dy})
        sources.files[layer] = write_text("grey.pfm", "Pf\n2 2\n-1.0\n" + bytes);
    const GradientImages images = read_gradient_images(sources);
    EXPECT_THAT(images.channels, ElementsAre("Y"));
    EXPECT_THAT(images.planes.at(GradientLayer::primal), ElementsAre(1, 2, 3, 4));
}

TEST_F(GradientLayers, MetadataIsThePrimals) {
    Image image = counting_image(3, 2, colours("", 100));
    image.metadata["seed"] = "5";
    GradientSources sources = three_files();
    sources.files[GradientLayer::primal] = write("p.exr", image);
    EXPECT_EQ(read_gradient_images(sources).metadata.at("seed"), "5");
}

TEST_F(GradientLayers, AMissingFileIsAMistakeOfTheCall) {
    GradientSources sources = three_files();
    sources.files.erase(GradientLayer::dy);
    expect_error(sources, ExitCode::usage, HasSubstr("there is no dy: give --dy FILE"));
    expect_error({}, ExitCode::usage, HasSubstr("--primal FILE, or one file with layers"));
    sources = three_files();
    sources.variances = true;
    expect_error(sources, ExitCode::usage, HasSubstr("there is no primal_variance: give --variance-primal FILE"));
}

TEST_F(GradientLayers, AMissingLayerListsThoseThatAreThere) {
    expect_error(layered(write("few.exr", counting_image(3, 2, layers({{"", 1}, {"primal", 100}, {"dx", 200}})))),
                 ExitCode::image,
                 AllOf(HasSubstr("few.exr' has no layer for dy"), HasSubstr("dx (R, G, B)"), HasSubstr("primal ("),
                       HasSubstr("channels without a layer (R, G, B)"), HasSubstr("--layer dy=NAME")));
    expect_error(layered(write_colours("plain.exr", 1)), ExitCode::image,
                 AllOf(HasSubstr("no layer for primal"), HasSubstr("`gradus render --layers` writes it")));
    GradientSources sources = layered(write_layers("named.exr"));
    sources.names[GradientLayer::primal] = "foo";
    expect_error(sources, ExitCode::image, HasSubstr("no layer \"foo\" for primal"));
    sources = layered(write_layers("all.exr"));
    sources.variances = true;
    expect_error(sources, ExitCode::image, HasSubstr("no layer for primal_variance"));
}

TEST_F(GradientLayers, SizesThatDifferNameBothFiles) {
    GradientSources sources = three_files();
    sources.files[GradientLayer::dy] = write("high.exr", counting_image(2, 3, colours("", 1)));
    expect_error(sources, ExitCode::image,
                 AllOf(HasSubstr("sizes differ"), HasSubstr("p.exr' is 3x2"), HasSubstr("high.exr' is 2x3"),
                       Not(HasSubstr("dx"))));
    sources = layered(write_layers("all.exr"));
    sources.files[GradientLayer::direct] = at("high.exr");
    expect_error(sources, ExitCode::image, AllOf(HasSubstr("primal of '"), HasSubstr("high.exr' is 2x3")));
}

TEST_F(GradientLayers, ChannelsThatDifferNameBothFiles) {
    GradientSources sources = three_files();
    sources.files[GradientLayer::dx] = write("grey.exr", counting_image(3, 2, {{"Y", 1}}));
    expect_error(sources, ExitCode::image,
                 AllOf(HasSubstr("channels differ"), HasSubstr("p.exr' has R, G, B"), HasSubstr("grey.exr' has Y")));
}

TEST_F(GradientLayers, ChannelsThatAreNoColours) {
    for (const auto &channels : std::vector<std::vector<std::pair<std::string, float>>>{
             {{"X", 1}, {"Y", 1}, {"Z", 1}}, {{"R", 1}, {"G", 1}}, {{"Z", 1}}}) {
        GradientSources sources = three_files();
        sources.files[GradientLayer::dx] = write("strange.exr", counting_image(3, 2, channels));
        expect_error(sources, ExitCode::image,
                     AllOf(HasSubstr("strange.exr' has the channels"), HasSubstr("R, G and B, or Y alone")));
    }
}

TEST_F(GradientLayers, FilesThatAreNoImages) {
    for (const std::string &path : {at("none.exr"), write_text("text.exr", "no image"), write_text("short.exr", ""),
                                    write_text("empty.pfm", "PF\n0 0\n-1.0\n")}) {
        GradientSources sources = three_files();
        sources.files[GradientLayer::dx] = path;
        expect_error(sources, ExitCode::image, HasSubstr("cannot read the image '" + path));
    }
}

/// Layers of a guided render: halves with so much of each, and features.
std::vector<std::pair<std::string, float>> guided_layers(const std::vector<std::string> &of_each_half) {
    std::vector<std::pair<std::string, float>> names{{"albedo", 1}};
    for (const std::string &layer : of_each_half)
        for (const char *half : {"_even", "_odd"}) {
            const std::size_t end = std::min(layer.find("_variance"), layer.size());
            names.emplace_back(layer.substr(0, end) + half + layer.substr(end), float(10 * names.size()));
        }
    std::vector<std::pair<std::string, float>> channels = layers(names);
    for (const char *name : {"normal.X", "normal.Y", "normal.Z", "depth.Z"})
        channels.emplace_back(name, float(channels.size()));
    return channels;
}

TEST_F(GradientLayers, HalvesForAGuideHaveFeaturesAndAllDifferencesOrNone) {
    GradientSources sources;
    sources.layered = "layers.exr";
    sources.halves = sources.features = true;
    sources.layered = write("path-traced.exr", counting_image(3, 2, guided_layers({"primal"})));
    GradientImages images = read_gradient_images(sources);
    EXPECT_EQ(images.find(GradientLayer::dx_even), nullptr);
    EXPECT_EQ(images.planes.at(GradientLayer::normal).size(), 18u);
    EXPECT_EQ(images.planes.at(GradientLayer::depth).size(), 6u);
    EXPECT_EQ(images.find(GradientLayer::normal)[6], images.find(GradientLayer::normal)[0] + 1) << "X, then Y";
    const std::vector<std::string> all{"primal", "dx", "dy", "primal_variance", "dx_variance", "dy_variance"};
    sources.layered = write("all.exr", counting_image(3, 2, guided_layers(all)));
    images = read_gradient_images(sources);
    EXPECT_NE(images.find(GradientLayer::dy_odd_variance), nullptr);
    sources.layered = write("some.exr", counting_image(3, 2, guided_layers({all.begin(), all.end() - 1})));
    expect_error(sources, ExitCode::image, HasSubstr("there is no dy_even_variance"));
    auto without = guided_layers({"primal"});
    without.pop_back();
    sources.layered = write("flat.exr", counting_image(3, 2, without));
    expect_error(sources, ExitCode::image, HasSubstr("no layer for depth"));
    without.emplace_back("depth.Y", 1.0f);
    sources.layered = write("y.exr", counting_image(3, 2, without));
    expect_error(sources, ExitCode::image, HasSubstr("there must be Z"));
    auto grey = guided_layers({"primal"});
    std::erase_if(grey, [](const auto &channel) { return channel.first.starts_with("albedo."); });
    grey.emplace_back("albedo.Y", 1.0f);
    sources.layered = write("grey-albedo.exr", counting_image(3, 2, grey));
    expect_error(sources, ExitCode::image, AllOf(HasSubstr("R, G and B"), Not(HasSubstr("Y alone"))));
}

} // namespace
} // namespace gradus
