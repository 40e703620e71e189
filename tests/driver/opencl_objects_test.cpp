// Renders under a layer that keeps books of OpenCL's objects (checked_opencl.cpp): no kernel is launched with a buffer
// that is gone, and all that is made is released.
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <cstdlib>

namespace gradus {
namespace {

using ::testing::StartsWith;

class OpenclObjects : public ProgramTest {
  protected:
    void TearDown() override {
        ::unsetenv("LD_PRELOAD");
        ::unsetenv("GRADUS_TEST_OPENCL_REPORT");
        ::unsetenv("GRADUS_TEST_FAILING_CALL");
        ProgramTest::TearDown();
    }
    /// What the layer says of a render. `beneath`: another layer.
    std::string render(const std::string &method, const std::string &reconstruction, const std::string &beneath = "",
                       int exit_code = 0) const {
        ::setenv("LD_PRELOAD", (GRADUS_CHECKED_OPENCL " " + beneath).c_str(), 1);
        ::setenv("GRADUS_TEST_OPENCL_REPORT", at("report.txt").c_str(), 1);
        const Outcome outcome =
            run({"render", GRADUS_SCENES "/cornell-box.xml", "-o", "out.exr", "--size", "8x8", "--spp", "4", "--method",
                 method, "--reconstruction", reconstruction, "--photons", "30000", "-q"});
        ::unsetenv("LD_PRELOAD");
        EXPECT_EQ(outcome.exit_code, exit_code) << outcome.err;
        return text_of("report.txt");
    }
};

/// 30,000 photons are more than their tables first have room for.
TEST_F(OpenclObjects, AreThereWhileTheyAreUsedAndThenReleased) {
    for (const auto &[method, reconstruction] : {std::pair{"pt", "guided"},
                                                 {"gpt", "l1"},
                                                 {"gpt", "weighted"},
                                                 {"gpt", "guided"},
                                                 {"gpm", "l1"},
                                                 {"gpm", "weighted"}})
        EXPECT_THAT(render(method, reconstruction), StartsWith("launches: ")) << method << " " << reconstruction;
}

/// Calls that fail while kernels are loaded, and while they run.
TEST_F(OpenclObjects, AreReleasedWhereARenderFails) {
    for (const char *call : {"300", "1500"}) {
        ::setenv("GRADUS_TEST_FAILING_CALL", call, 1);
        EXPECT_THAT(render("gpt", "weighted", GRADUS_FAILING_OPENCL, 4), StartsWith("launches: ")) << call;
    }
}

} // namespace
} // namespace gradus
