// Links that lead elsewhere by the time a file is read: whatever the swapping hits, nothing of a file outside comes in.
#include "runtime/io/bitmap_reader.h"
#include "runtime/io/environment_file.h"
#include "runtime/io/file_search.h"
#include "runtime/io/image_io.h"
#include "runtime/scene/environment_map.h"
#include "tests/io/scene_text.h"

#include <fcntl.h>
#include <functional>
#include <thread>

namespace gradus {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Has a link lead to one place and to another in turn, as fast as it can, until it goes.
class SwappedLink {
  public:
    SwappedLink(const fs::path &link, const fs::path &first, const fs::path &second)
        : link_(link.string()), other_(link_ + ".other") {
        fs::create_symlink(first, link_);
        fs::create_symlink(second, other_);
        thread_ = std::thread([this] {
            // At once: the name always leads somewhere.
            while (!ends_ && ::renameat2(AT_FDCWD, link_.c_str(), AT_FDCWD, other_.c_str(), RENAME_EXCHANGE) == 0)
                continue;
        });
    }
    ~SwappedLink() {
        ends_ = true;
        thread_.join();
        fs::remove(link_);
        fs::remove(other_);
    }
    SwappedLink(const SwappedLink &) = delete;
    SwappedLink &operator=(const SwappedLink &) = delete;

  private:
    std::string link_, other_;
    std::atomic<bool> ends_ = false;
    std::thread thread_;
};

Image plain_image(float green) {
    Image image;
    image.width = 2;
    image.height = 1;
    for (const char *name : {"R", "G", "B"})
        image.channels.push_back({name, std::vector<float>(2, name == std::string("G") ? green : 1.0f)});
    return image;
}

/// What a scene says of the file that it names, and how to tell the file outside by what was loaded.
struct Reader {
    const char *name, *file;
    std::string element;
    std::function<bool(const Scene &)> is_foreign;
};

class ConfinedLinks : public testing::TestWithParam<Reader> {
  protected:
    void SetUp() override {
        const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        const std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty "
                                "float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 "
                                "0\n0 1 ";
        folder_.write("scene/own/mesh.obj", triangle);
        folder_.write("outside/mesh.obj", triangle + "f 1 2 3\n");
        folder_.write("scene/own/broken.obj", "v 0 0 mine\n");
        folder_.write("outside/broken.obj", "v 0 0 hunter2\n");
        folder_.write("scene/own/mesh.ply", ply + "0\n3 0 1 2\n");
        folder_.write("outside/mesh.ply", ply + "9\n3 0 1 2\n");
        folder_.write("scene/own/part.xml", "<scene version=\"3.0.0\"><shape type=\"sphere\"/></scene>");
        folder_.write("outside/part.xml",
                      "<scene version=\"3.0.0\"><shape type=\"sphere\"/><shape type=\"sphere\"/></scene>");
        folder_.write("scene/own/picture.ppm", std::string("P6 1 1 255\n\xff\x00\xff", 14));
        folder_.write("outside/picture.ppm", std::string("P6 1 1 255\n\xff\xff\xff", 14));
        for (const bool own : {true, false})
            write_image(plain_image(own ? 0.0f : 1.0f),
                        (folder_.path() / (own ? "scene/own" : "outside") / "map.exr").string());
        options_.confined = true;
    }

    /// Loads the scene again and again while the link that its file lies behind swaps.
    void expect_nothing_foreign(const std::string &written, const fs::path &link, const fs::path &own,
                                const fs::path &outside) {
        // A long way there: the link is followed when it is found, and again when it is opened, a walk later.
        std::string way;
        for (int i = 0; i < 400; ++i)
            way += "own/../";
        std::string element = GetParam().element;
        element.replace(element.find("NAME"), 4, way + written);
        const std::string scene =
            folder_.write("scene/scene.xml", scene_around(element, "3.0.0", "<shape type=\"sphere\"/>"));
        int loaded = 0, refused = 0, foreign = 0;
        const SwappedLink swapped(link, own, outside);
        for (int i = 0; i < 30; ++i)
            try {
                foreign += GetParam().is_foreign(load_scene(scene, options_).scene);
                ++loaded;
            } catch (const Error &error) {
                const std::string message = error.what();
                foreign += message.find("hunter2") != std::string::npos;
                ++(message.find("mine") != std::string::npos ? loaded : refused);
            }
        // How many are refused goes by how busy the machine is.
        EXPECT_EQ(foreign, 0) << "of " << loaded << " that were loaded and " << refused << " that were refused";
    }

    TemporaryFolder folder_;
    LoadOptions options_;
};

TEST_P(ConfinedLinks, ToAFileNeverLeadOutside) {
    const fs::path link = folder_.path() / "scene" / ("link-" + std::string(GetParam().file));
    expect_nothing_foreign(link.filename().string(), link, fs::path("own") / GetParam().file,
                           folder_.path() / "outside" / GetParam().file);
}

TEST_P(ConfinedLinks, ToAFolderNeverLeadOutside) {
    expect_nothing_foreign(std::string("folder/") + GetParam().file, folder_.path() / "scene/folder", "own",
                           folder_.path() / "outside");
}

std::string mesh_of(const std::string &type) {
    return "<shape type=\"" + type + "\"><string name=\"filename\" value=\"NAME\"/></shape>";
}

INSTANTIATE_TEST_SUITE_P(
    Readers, ConfinedLinks,
    testing::Values(
        Reader{"obj", "mesh.obj", mesh_of("obj"),
               [](const Scene &scene) { return scene.meshes.at(0).triangles.size() != 1; }},
        Reader{"message", "broken.obj", mesh_of("obj"), [](const Scene &) { return true; }},
        Reader{"ply", "mesh.ply", mesh_of("ply"),
               [](const Scene &scene) { return scene.meshes.at(0).positions.at(2).z != 0; }},
        Reader{"include", "part.xml", "<include filename=\"NAME\"/>",
               [](const Scene &scene) { return scene.spheres.size() != 2; }},
        Reader{"texture", "picture.ppm",
               "<shape type=\"sphere\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\"><string "
               "name=\"filename\" value=\"NAME\"/></texture></bsdf></shape>",
               [](const Scene &scene) { return scene.textures.at(0).bitmap->channel(0, 0, 1) != 0; }},
        Reader{"environment", "map.exr",
               "<emitter type=\"envmap\"><string name=\"filename\" value=\"NAME\"/></emitter>",
               [](const Scene &scene) { return scene.emitters.at(0).map->integral.g != 0; }}),
    [](const auto &tested) { return tested.param.name; });

/// A link in a folder that a finder is confined to, which leads from one file to another once it is told to.
class TurnedLink : public testing::Test {
  protected:
    void SetUp() override {
        for (const bool own : {true, false}) {
            const std::string at = own ? "scene/own/" : "outside/";
            folder_.write(at + "text", own ? "mine" : "hunter2");
            write_image(plain_image(own ? 0.0f : 1.0f), (folder_.path() / (at + "map.exr")).string());
            write_png(plain_image(own ? 0.0f : 1.0f), (folder_.path() / (at + "map.png")).string());
        }
        fs::create_symlink("own", link());
        finder_.confine({folder_.path() / "scene"});
    }
    fs::path link() const { return folder_.path() / "scene/link"; }
    fs::path found(const std::string &name) {
        const auto file = finder_.find("link/" + name, {folder_.path() / "scene"});
        return file ? file->path : "nothing";
    }
    /// Where it leads from now on.
    void turn(const fs::path &target) const {
        fs::remove(link());
        fs::create_symlink(target, link());
    }
    TemporaryFolder folder_;
    FileFinder finder_;
};

TEST_F(TurnedLink, AfterItWasFollowedIsJudgedAnew) {
    for (const char *name : {"text", "map.exr"}) {
        turn("own");
        const fs::path path = found(name);
        EXPECT_NE(finder_.open(path), nullptr);
        turn("../outside");
        EXPECT_EQ(finder_.open(path), nullptr);
        turn(folder_.path() / "outside");
        EXPECT_EQ(finder_.open(path), nullptr);
        FileFinder free;
        EXPECT_NE(free.open(path), nullptr) << "by those who trust the scene";
    }
}

TEST_F(TurnedLink, AfterAFileWasOpenedLeadsToItNoMore) {
    const auto text = finder_.open(found("text")), map = finder_.open(found("map.exr")),
               picture = finder_.open(found("map.png"));
    ASSERT_TRUE(text && map && picture);
    turn("../outside");
    EXPECT_EQ(text->read(), "mine");
    EXPECT_EQ(fs::canonical(text->place()), fs::canonical(folder_.path() / "scene/own/text"));
    EXPECT_EQ(text->bytes(), 4u);
    for (const auto &file : {map, picture}) {
        EXPECT_EQ(read_image(*file).find("G")->values.at(0), 0);
        EXPECT_EQ(read_bitmap(*file, {}).bitmap.channel(0, 0, 1), 0);
    }
    Diagnostics diagnostics(false);
    EXPECT_EQ(read_environment(*map, 1, {}, diagnostics)->integral.g, 0);
}

// Names in folders outside are not for comparing.
TEST_F(TurnedLink, AFolderOutsideIsNotListed) {
    turn("../outside");
    EXPECT_FALSE(finder_.find("LINK/TEXT", {folder_.path() / "scene"}));
    turn("own");
    EXPECT_FALSE(finder_.find("LINK/TEXT", {folder_.path() / "scene"})) << "it was found empty before";
    FileFinder other;
    other.confine({folder_.path() / "scene"});
    EXPECT_TRUE(other.find("LINK/TEXT", {folder_.path() / "scene"}));
}

/// Pictures of confined scenes.
class ConfinedPictures : public testing::Test {
  protected:
    void SetUp() override { options_.confined = true; }
    std::string error_with_texture(const std::string &file) {
        return error_of(
            folder_.write("scene/scene.xml",
                          scene_around("<shape type=\"sphere\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" "
                                       "name=\"reflectance\"><string name=\"filename\" value=\"" +
                                       file + "\"/></texture></bsdf></shape>")),
            options_);
    }
    TemporaryFolder folder_;
    LoadOptions options_;
};

TEST_F(ConfinedPictures, AreReadWhateverTheirNamesEndIn) {
    folder_.write("scene/own/none", "");
    write_image(plain_image(0.5f), (folder_.path() / "scene/own/picture.exr").string());
    write_png(plain_image(0.5f), (folder_.path() / "scene/own/picture.png").string());
    folder_.write("scene/own/picture.ppm", std::string("P6 1 1 255\n\xff\x00\xff", 14));
    for (const char *kind : {"exr", "png", "ppm"}) {
        const std::string name = std::string("own/picture.") + kind;
        EXPECT_EQ(error_with_texture(name), "");
        for (const char *other : {"", ".png", ".mp4"}) {
            const std::string renamed = std::string("own/as-") + kind + other;
            fs::copy_file(folder_.path() / "scene" / name, folder_.path() / "scene" / renamed);
            EXPECT_EQ(error_with_texture(renamed), "") << renamed;
        }
    }
}

/// A playlist names the files that are shown. Who trusts the scene may have it.
TEST_F(ConfinedPictures, AreOfFormatsThatReadNoOtherFile) {
    for (const char *name : {"list.mp4", "list.m3u8", "list.avi"}) {
        folder_.write(std::string("scene/") + name,
                      "#EXTM3U\n#EXT-X-TARGETDURATION:1\n#EXTINF:1,\nfile:///etc/film.ts\n");
        const std::string message = error_with_texture(name);
        EXPECT_THAT(message, HasSubstr("with --confined the formats are openexr, png"));
        EXPECT_THAT(message, testing::Not(HasSubstr("/proc/"))) << "the file by its own name";
    }
    folder_.write("scene/list.png", "no picture");
    EXPECT_THAT(error_with_texture("list.png"), testing::Not(HasSubstr("/proc/")));
}

} // namespace
} // namespace gradus
