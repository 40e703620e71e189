// `gradus solve` as a process: what it prints, what it writes, and what it leaves where it cannot.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"
#include "tests/driver/gradient_images.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gradus {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Solve : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        write_layers(8, 6);
    }
    void write_layers(std::uint32_t width, std::uint32_t height) const {
        write_image(counting_image(width, height, layers({{"primal", 0}, {"dx", 1}, {"dy", 2}})), at("layers.exr"));
    }
    Outcome solve(std::vector<std::string> options, std::size_t file_size_limit = 0) const {
        options.insert(options.begin(), {"solve", "layers.exr", "-o", "out.exr"});
        return run(options, file_size_limit);
    }
};

TEST_F(Solve, PrintsTheResultAndWritesTheImage) {
    const Outcome outcome = solve({});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("method       fake method\n"));
    EXPECT_THAT(outcome.out, HasSubstr("seconds      0.250, "));
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(files(), ElementsAre("layers.exr", "out.exr", "scene.xml"));
    const Image image = read_image(at("out.exr"));
    EXPECT_EQ(image.channels.size(), 3u);
    EXPECT_EQ(image.find("G")->values.at(1), 11);
}

TEST_F(Solve, WritesPngAndStatisticsQuietly) {
    const Outcome outcome = solve({"--png", "--stats", "out.json", "--quiet"});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.out + outcome.err, "");
    EXPECT_THAT(files(), ElementsAre("layers.exr", "out.exr", "out.json", "out.png", "scene.xml"));
    EXPECT_EQ(nlohmann::json::parse(text_of("out.json")).at("method"), "fake method");
}

TEST_F(Solve, StatisticsToStandardOutputReplaceTheText) {
    const Outcome outcome = solve({"--stats", "-"});
    ASSERT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(nlohmann::json::parse(outcome.out).at("width"), 8);
}

TEST_F(Solve, AFullDiskLeavesNothingHalfWritten) {
    write_layers(200, 200);
    const Outcome outcome = solve({}, 600);
    EXPECT_EQ(outcome.exit_code, 5) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("File too large"));
    EXPECT_EQ(outcome.out, "");
    EXPECT_THAT(files(), ElementsAre("layers.exr", "scene.xml"));
}

TEST_F(Solve, AFailedWriteKeepsTheOldImage) {
    ASSERT_EQ(solve({}).exit_code, 0);
    const std::string before = text_of("out.exr");
    write_layers(200, 200);
    EXPECT_EQ(solve({}, 600).exit_code, 5);
    EXPECT_EQ(text_of("out.exr"), before);
    EXPECT_THAT(files(), ElementsAre("layers.exr", "out.exr", "scene.xml"));
}

TEST_F(Solve, ADeviceThatIsTooSmallLeavesNothing) {
    const Outcome outcome = solve({"--device", "too small"});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_EQ(outcome.err, "gradus: error: the fake device is too small for 8x6 pixels\n");
    EXPECT_THAT(files(), ElementsAre("layers.exr", "scene.xml"));
}

} // namespace
} // namespace gradus
