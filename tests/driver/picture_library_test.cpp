// What a render does without the library that writes pictures.
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>

namespace gradus {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class PictureLibrary : public ProgramTest {
  protected:
    void TearDown() override {
        unsetenv("GRADUS_PICTURES");
        ProgramTest::TearDown();
    }
    Outcome render_with(const std::string &library) const {
        setenv("GRADUS_PICTURES", library.c_str(), 1);
        return run({"render", "scene.xml", "-o", "out.exr", "--png"});
    }
};

TEST_F(PictureLibrary, WithoutItNothingIsBegun) {
    const Outcome outcome = render_with(at("nothing.so"));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("nothing.so"), HasSubstr("install Gradus again"), Not(HasSubstr("rendering"))));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

TEST_F(PictureLibrary, ImagesOfOpenExrDoNotNeedIt) {
    setenv("GRADUS_PICTURES", at("nothing.so").c_str(), 1);
    EXPECT_EQ(run({"render", "scene.xml", "-o", "out.exr"}).exit_code, 0);
    EXPECT_EQ(run({"compare", "out.exr", "out.exr"}).exit_code, 0);
}

TEST_F(PictureLibrary, WhatIsNoneIsRefused) {
    std::ofstream(at("text.so")) << "text";
    const Outcome outcome = render_with(at("text.so"));
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("text.so"), HasSubstr("install Gradus again"), Not(HasSubstr("rendering"))));
    EXPECT_THAT(files(), ElementsAre("scene.xml", "text.so"));
}

TEST_F(PictureLibrary, AnotherVersionsIsRefused) {
    const Outcome outcome = render_with(GRADUS_OTHER_PICTURES);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("is not of Gradus 0.1.0"));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

} // namespace
} // namespace gradus
