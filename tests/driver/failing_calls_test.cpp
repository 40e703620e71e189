// A short render of which the n-th OpenCL call fails, for every n: it ends, with a clear error and exit code 4, or as
// if nothing had been where the program has another way.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace gradus {
namespace {

using ::testing::HasSubstr;

class FailingCalls : public ProgramTest {
  protected:
    void SetUp() override {
        ProgramTest::SetUp();
        ::setenv("LD_PRELOAD", GRADUS_FAILING_OPENCL, 1);
    }
    void TearDown() override {
        for (const char *name : {"LD_PRELOAD", "GRADUS_TEST_FAILING_CALL", "GRADUS_TEST_CALLS"})
            ::unsetenv(name);
        ProgramTest::TearDown();
    }

    Outcome render(const std::string &method) const {
        return run({"render", GRADUS_SCENES "/cornell-box.xml", "-o", "out.exr", "--size", "8x8", "--spp", "1",
                    "--method", method, "-q"});
    }
    /// How many calls a render makes. The first one fills the cache of programs.
    long count_calls(const std::string &method) const {
        EXPECT_EQ(render(method).exit_code, 0);
        ::setenv("GRADUS_TEST_CALLS", at("calls").c_str(), 1);
        EXPECT_EQ(render(method).exit_code, 0);
        ::unsetenv("GRADUS_TEST_CALLS");
        long calls = 0;
        std::ifstream(at("calls")) >> calls;
        return calls;
    }
    /// Fails so many calls, evenly spread, one a render; 0: each.
    void fail_calls(const std::string &method, long how_many) {
        const long calls = count_calls(method);
        ASSERT_GT(calls, 500);
        const Image whole = read_image(at("out.exr"));
        const long step = how_many > 0 ? std::max(1L, calls / how_many) : 1;
        long failed = 0;
        for (long n = 1; n <= calls; n += step) {
            std::filesystem::remove(at("out.exr"));
            ::setenv("GRADUS_TEST_FAILING_CALL", std::to_string(n).c_str(), 1);
            const Outcome outcome = render(method);
            const std::string which = "call " + std::to_string(n) + " of " + std::to_string(calls);
            ASSERT_EQ(outcome.signal, 0) << which << " crashes or hangs: " << outcome.err;
            if (outcome.exit_code == 0) {
                const Image image = read_image(at("out.exr"));
                for (const Channel &channel : whole.channels)
                    EXPECT_EQ(channel.values, image.find(channel.name)->values) << which;
                continue;
            }
            ++failed;
            EXPECT_EQ(outcome.exit_code, 4) << which << ": " << outcome.err;
            EXPECT_THAT(outcome.err, HasSubstr("gradus: error: ")) << which;
        }
        RecordProperty("calls", std::to_string(calls));
        RecordProperty("failed", std::to_string(failed));
        std::printf("%s: %ld calls, every %ldth failed in turn, %ld renders ended with an error\n", method.c_str(),
                    calls, step, failed);
        EXPECT_GT(failed, 0);
    }
};

#ifdef GRADUS_ALL_CALLS
TEST_F(FailingCalls, EachCallOfPathTracing) { fail_calls("pt", 0); }
TEST_F(FailingCalls, ManyCallsOfGradientDomainPathTracing) { fail_calls("gpt", 400); }

/// An address space from too small for anything to large enough: an error that says so, or the whole image.
TEST_F(FailingCalls, MemoryForAnyPartOfTheRender) {
    ::unsetenv("LD_PRELOAD");
    int refused = 0, rendered = 0;
    for (std::size_t limit = 600; limit <= 1800; limit += 25)
        for (const char *method : {"pt", "gpt"}) {
            std::filesystem::remove(at("out.exr"));
            const Outcome outcome = run({"render", GRADUS_SCENES "/cornell-box.xml", "-o", "out.exr", "--size",
                                         "256x256", "--spp", "2", "--method", method, "-q"},
                                        0, limit << 20);
            if (outcome.exit_code == 127) // not even the libraries
                continue;
            const std::string which = std::string(method) + " in " + std::to_string(limit) + " MB: " + outcome.err;
            EXPECT_EQ(outcome.signal, 0) << which;
            if (outcome.exit_code == 0) {
                ++rendered;
                EXPECT_EQ(read_image(at("out.exr")).metadata.at("partial"), "false") << which;
                continue;
            }
            ++refused;
            EXPECT_EQ(outcome.exit_code, 4) << which;
            EXPECT_THAT(outcome.err, HasSubstr("gradus: error: ")) << which;
        }
    std::printf("%d renders in too little memory ended with an error, %d were whole\n", refused, rendered);
    EXPECT_GT(refused, 0);
    EXPECT_GT(rendered, 0);
}

/// The same for numbers of threads: each takes its part of the address space, and what waits for one that could not be
/// started waits for ever.
TEST_F(FailingCalls, MemoryForAnyNumberOfThreads) {
    ::unsetenv("LD_PRELOAD");
    for (const char *threads : {"1", "8", "32"}) {
        int refused = 0, rendered = 0;
        for (std::size_t limit = 1300; limit <= 2500; limit += 75) {
            const Outcome outcome = run({"render", GRADUS_SCENES "/cornell-box.xml", "-o", "out.exr", "--size", "64x64",
                                         "--spp", "2", "--method", "gpt", "-q", "--nthreads", threads},
                                        0, limit << 20);
            const std::string which = std::string(threads) + " in " + std::to_string(limit) + " MB: " + outcome.err;
            EXPECT_EQ(outcome.signal, 0) << which;
            EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 4) << which;
            ++(outcome.exit_code == 0 ? rendered : refused);
        }
        std::printf("%s threads: %d renders were refused, %d were whole\n", threads, refused, rendered);
        EXPECT_GT(rendered, 0) << threads;
    }
}
#else
TEST_F(FailingCalls, SomeCallsOfPathTracing) { fail_calls("pt", 7); }
#endif

} // namespace
} // namespace gradus
