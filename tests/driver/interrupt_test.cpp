// Renders that are interrupted, killed, or looked at while they run.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <thread>

namespace gradus {
namespace {

using ::testing::ElementsAre;

/// Milliseconds after which a signal is no longer taken for one with the signal before.
constexpr int past_one_wish = 400;

void sleep_ms(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }

class Interrupt : public ProgramTest {
  protected:
    /// A render without an end. Its first partial image says that it is under way.
    std::vector<std::string> endless(const std::string &batch_ms = "5") const {
        return {"render",  "scene.xml",       "-o",   "out.exr", "--spp",
                "1000000", "--write-partial", "0.02", "-D",      "batch_ms=" + batch_ms};
    }
    void expect_valid_partial_image() const {
        const Image image = read_image(at("out.exr"));
        EXPECT_EQ(image.metadata.at("partial"), "true");
        const float samples = image.find("G")->values.at(0);
        EXPECT_GE(samples, 1);
        EXPECT_EQ(image.metadata.at("samples"), std::to_string(48 * int(samples)));
        EXPECT_EQ(std::stof(image.metadata.at("spp")), samples);
    }
};

TEST_F(Interrupt, ASignalLeavesAValidImageOfWhatThereIs) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        ChildProcess process(endless(), folder);
        ASSERT_TRUE(wait_for_file("out.exr"));
        process.send(number);
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
        EXPECT_THAT(outcome.err, ::testing::HasSubstr("interrupted; wrote out.exr"));
        expect_valid_partial_image();
        EXPECT_THAT(files(), ElementsAre("out.exr", "scene.xml"));
        std::filesystem::remove(at("out.exr"));
    }
}

/// There is nothing to save yet, as while kernels compile.
TEST_F(Interrupt, ASignalDuringThePilotEndsAtOnceAndLeavesNothing) {
    ChildProcess process({"render", "scene.xml", "-o", "out.exr", "--method", "auto", "-D", "pilot_ms=50000"}, folder);
    sleep_ms(500);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.signal, SIGINT);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 10);
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
}

TEST_F(Interrupt, ASignalBeforeTheFirstSamplesTouchesNoFile) {
    ChildProcess process({"render", "scene.xml", "-o", "out.exr", "--stats", "out.json", "-D", "endless=0"}, folder);
    process.wait_until_it_hears(SIGINT);
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, ::testing::HasSubstr("interrupted before the first samples"));
    EXPECT_THAT(files(), ElementsAre("scene.xml"));
    // Who asks for quiet shall know, too, why there is no image.
    ChildProcess quiet({"render", "scene.xml", "-o", "out.exr", "-q", "-D", "endless=0"}, folder);
    quiet.wait_until_it_hears(SIGINT);
    quiet.send(SIGINT);
    EXPECT_THAT(quiet.wait().err, ::testing::HasSubstr("interrupted before the first samples"));
}

TEST_F(Interrupt, ASecondSignalEndsAtOnce) {
    // The file is there once the first batch is done; the second takes another 1.5 s.
    ChildProcess process(
        {"render", "scene.xml", "-o", "out.exr", "--write-partial", "0.001", "--spp", "10", "-D", "batch_ms=1500"},
        folder);
    ASSERT_TRUE(wait_for_file("out.exr"));
    sleep_ms(100);
    process.send(SIGINT);
    sleep_ms(past_one_wish);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.signal, SIGINT);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 0.8);
    expect_valid_partial_image();
}

/// As of `timeout`, which sends one to the program and then one to its group.
TEST_F(Interrupt, SignalsThatComeTogetherAreOne) {
    for (const int wait : {0, 1, 10}) { // ms
        ChildProcess process(endless(), folder);
        ASSERT_TRUE(wait_for_file("out.exr"));
        for (const int number : {SIGTERM, SIGTERM, SIGINT}) {
            process.send(number);
            sleep_ms(wait);
        }
        const Outcome outcome = process.wait();
        EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
        expect_valid_partial_image();
        std::filesystem::remove(at("out.exr"));
    }
}

/// A shell and the kernel send one each when a terminal goes.
TEST_F(Interrupt, ATerminalThatGoesTwiceLosesNothing) {
    ChildProcess process({"render", "scene.xml", "-o", "out.exr", "--spp", "1", "-D", "image_ms=1500"}, folder);
    process.wait_until_it_hears(SIGHUP);
    sleep_ms(500);
    for (int i = 0; i < 2; ++i) {
        process.send(SIGHUP);
        sleep_ms(past_one_wish);
    }
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "false");
}

/// All samples are done: one signal loses nothing and is answered at once, a second one ends the program.
TEST_F(Interrupt, ASignalWhileTheImageIsMadeIsAnswered) {
    for (const int signals : {1, 2}) {
        ChildProcess process({"render", "scene.xml", "-o", "out.exr", "--spp", "1", "-D", "image_ms=1500"}, folder);
        process.wait_until_it_hears(SIGINT);
        sleep_ms(500);
        for (int i = 0; i < signals; ++i) {
            process.send(SIGINT);
            sleep_ms(past_one_wish);
        }
        const Outcome outcome = process.wait();
        EXPECT_THAT(outcome.err, ::testing::HasSubstr("the image is being made: a second time loses it"));
        EXPECT_EQ(outcome.exit_code == 0, signals == 1) << outcome.err;
        EXPECT_EQ(std::filesystem::exists(at("out.exr")), signals == 1);
        std::filesystem::remove(at("out.exr"));
    }
}

TEST_F(Interrupt, PartialImagesAreWholeWheneverTheyAreRead) {
    ChildProcess process(endless("1"), folder);
    ASSERT_TRUE(wait_for_file("out.exr"));
    float last = 0;
    for (int i = 0; i < 100; ++i) {
        expect_valid_partial_image();
        const float samples = read_image(at("out.exr")).find("G")->values.at(0);
        EXPECT_GE(samples, last);
        last = samples;
        sleep_ms(2);
    }
    EXPECT_GT(last, 10) << "the image was not written again";
    process.send(SIGTERM);
    EXPECT_EQ(process.wait().exit_code, 130);
}

TEST_F(Interrupt, AKillAtAnyTimeLeavesAWholeImage) {
    for (int i = 0; i < 8; ++i) {
        std::filesystem::remove(at("out.exr"));
        ChildProcess process({"render", "scene.xml", "-o", "out.exr", "--spp", "100000000", "--write-partial", "1e-9"},
                             folder); // writes all the time
        ASSERT_TRUE(wait_for_file("out.exr"));
        sleep_ms(i * 3);
        process.send(SIGKILL);
        EXPECT_EQ(process.wait().signal, SIGKILL);
        expect_valid_partial_image();
    }
}

} // namespace
} // namespace gradus
