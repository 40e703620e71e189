// Scenes by strangers: which files they reach, and what of these files a message tells.
#include "tests/io/scene_text.h"

namespace gradus {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char *secret = "hunter2";
constexpr const char *triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A scene in a folder of its own, beside what it must not reach.
class Confined : public testing::Test {
  protected:
    void SetUp() override {
        options_.confined = true;
        folder_.write("outside/mesh.obj", triangle);
        folder_.write("outside/only.obj", triangle);
        folder_.write("outside/part.xml", "<scene version=\"3.0.0\"/>");
        folder_.write("scene/mesh.obj", triangle);
        folder_.write("scene/sub/Other.obj", triangle);
    }
    std::string outside(const std::string &name) const { return (folder_.path() / "outside" / name).string(); }
    std::string error_with_mesh(const std::string &name) {
        return error_with("<shape type=\"obj\"><string name=\"filename\" value=\"" + name + "\"/></shape>");
    }
    std::string error_with(const std::string &body) {
        return error_of(folder_.write("scene/scene.xml", scene_around(body, "3.0.0", "<emitter type=\"constant\"/>")),
                        options_);
    }

    TemporaryFolder folder_;
    LoadOptions options_;
};

TEST_F(Confined, FilesOfTheScenesFolderAreRead) {
    for (const char *name : {"mesh.obj", "sub/Other.obj", "./sub/../mesh.obj", "SUB/other.OBJ", "sub\\Other.obj"})
        EXPECT_EQ(error_with_mesh(name), "") << name;
    EXPECT_EQ(error_with_mesh((folder_.path() / "scene/mesh.obj").string()), "");
    EXPECT_EQ(
        error_with("<path value=\"sub\"/><shape type=\"obj\"><string name=\"filename\" value=\"Other.obj\"/></shape>"),
        "");
}

TEST_F(Confined, FilesOutsideAreNotFoundHoweverTheyAreNamed) {
    std::filesystem::create_symlink(outside("mesh.obj"), folder_.path() / "scene/link.obj");
    std::filesystem::create_directory_symlink(folder_.path() / "outside", folder_.path() / "scene/folder");
    std::filesystem::create_directory_symlink("/", folder_.path() / "scene/root");
    for (const std::string &name :
         {outside("mesh.obj"), std::string("../outside/mesh.obj"), std::string("link.obj"),
          std::string("folder/mesh.obj"), std::string("../OUTSIDE/mesh.obj"), std::string("sub/../../outside/mesh.obj"),
          std::string("FOLDER/mesh.obj"), "root" + outside("mesh.obj"), std::string("..\\outside\\mesh.obj")}) {
        EXPECT_THAT(error_with_mesh(name), AllOf(HasSubstr("cannot find the file"), HasSubstr("--confined"))) << name;
        options_.confined = false;
        EXPECT_EQ(error_with_mesh(name), "") << name << " is found by those who trust the scene";
        options_.confined = true;
    }
    EXPECT_THAT(error_with("<include filename=\"../outside/part.xml\"/>"), HasSubstr("--confined"));
    EXPECT_THAT(error_with("<path value=\"../outside\"/><include filename=\"part.xml\"/>"), HasSubstr("--confined"));
    EXPECT_THAT(error_with("<path value=\"" + outside("") +
                           "\"/><shape type=\"obj\"><string name=\"filename\" value=\"Only.obj\"/></shape>"),
                HasSubstr("--confined"));
}

/// A folder that begins with the same letters is another one.
TEST_F(Confined, FoldersAreComparedByTheirParts) {
    folder_.write("scene-of-others/mesh.obj", triangle);
    EXPECT_THAT(error_with_mesh("../scene-of-others/mesh.obj"), HasSubstr("--confined"));
}

TEST_F(Confined, WhatIsOutsideCannotBeToldFromWhatIsNot) {
    const std::string there = error_with_mesh("../outside/mesh.obj"),
                      not_there = error_with_mesh("../outside/nosh.obj");
    EXPECT_EQ(there.substr(there.find("file \"") + 20), not_there.substr(not_there.find("file \"") + 20));
}

TEST_F(Confined, FoldersCanBeAllowed) {
    options_.allowed_folders = {folder_.path() / "outside"};
    EXPECT_EQ(error_with_mesh("../outside/mesh.obj"), "");
    EXPECT_EQ(error_with_mesh("mesh.obj"), "");
    options_.allowed_folders = {folder_.path() / "nowhere"};
    EXPECT_THAT(error_with_mesh("mesh.obj"), HasSubstr("there is no folder"));
}

/// Any file can be named as a mesh or an include. What stands in it is not for whoever named it.
TEST_F(Confined, NoMessageTellsWhatStandsInAnotherFile) {
    options_.confined = false;
    const std::string bare = secret;
    const std::vector<std::string> contents{bare,
                                            "v " + bare,
                                            "f " + bare + " 2 3",
                                            "v 1 " + bare + " 2",
                                            "vn " + bare,
                                            "v 0 0 0\nf 1/" + bare,
                                            "v 0 0 0\nf 1," + bare,
                                            "<" + bare + "/>",
                                            "<config><" + bare + "/></config>",
                                            "<config>" + bare + "</config>",
                                            "<config version=\"" + bare + "\"/>",
                                            "<a/><" + bare + "/>",
                                            "<scene/><" + bare + "/>",
                                            "<" + bare,
                                            "ply" + bare};
    for (const std::string &content : contents)
        for (const char *type : {"obj", "ply", "serialized", "include"}) {
            folder_.write("outside/passwords", content);
            const std::string message =
                type == std::string("include")
                    ? error_with("<include filename=\"../outside/passwords\"/>")
                    : error_with("<shape type=\"" + std::string(type) +
                                 "\"><string name=\"filename\" value=\"../outside/passwords\"/></shape>");
            EXPECT_THAT(message, Not(HasSubstr(secret))) << type << ": " << content;
        }
    folder_.write("outside/numbers", "v 0 0 0\nf 271828 1 1\n");
    EXPECT_THAT(error_with_mesh("../outside/numbers"), AllOf(HasSubstr("out of range"), Not(HasSubstr("271828"))));
    // A link that is called as if it were a mesh, to what is none.
    std::filesystem::create_symlink(outside("numbers"), folder_.path() / "scene/link.obj");
    EXPECT_THAT(error_with_mesh("link.obj"), AllOf(HasSubstr("out of range"), Not(HasSubstr("271828"))));
}

} // namespace
} // namespace gradus
