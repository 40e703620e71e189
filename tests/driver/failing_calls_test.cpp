// A short render of which the n-th OpenCL call fails: it ends, with a clear error and exit code 4, or as
// if nothing had been where the program has another way.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

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
        for (const char *name : {"LD_PRELOAD", "GRADUS_TEST_FAILING_CALL", "GRADUS_TEST_CALLS",
                                 "GRADUS_TEST_THROWING_BUILD", "POCL_DEVICES"})
            ::unsetenv(name);
        ProgramTest::TearDown();
    }

    struct Render {
        std::string method, size = "8x8";
    };
    Outcome render(const Render &what) const {
        return run({"render", GRADUS_SCENES "/cornell-box.xml", "-o", "out.exr", "--size", what.size, "--spp", "1",
                    "--method", what.method, "-q"});
    }
    /// How many calls a render makes, and of these the first and the last from each place (failing_opencl.cpp).
    struct Calls {
        long count = 0;
        std::vector<long> by_place;
    };
    /// The first render fills the cache of programs.
    Calls calls_of(const Render &what) const {
        EXPECT_EQ(render(what).exit_code, 0);
        ::setenv("GRADUS_TEST_CALLS", at("calls").c_str(), 1);
        EXPECT_EQ(render(what).exit_code, 0);
        ::unsetenv("GRADUS_TEST_CALLS");
        Calls calls;
        std::ifstream file(at("calls"));
        file >> calls.count;
        for (long number = 0; file >> number;)
            calls.by_place.push_back(number);
        return calls;
    }
    static std::vector<long> each(const Calls &calls) {
        std::vector<long> all(calls.count);
        std::iota(all.begin(), all.end(), 1);
        return all;
    }
    static std::vector<long> by_place(const Calls &calls) { return calls.by_place; }

    /// Fails the calls that `choose` takes, one a render.
    template <class Choose>
    void fail_calls(const Render &what, const Choose &choose) {
        const Calls calls = calls_of(what);
        ASSERT_GT(calls.count, 500);
        const std::vector<long> chosen = choose(calls);
        ASSERT_FALSE(chosen.empty());
        const Image whole = read_image(at("out.exr"));
        long failed = 0;
        for (const long n : chosen) {
            std::filesystem::remove(at("out.exr"));
            ::setenv("GRADUS_TEST_FAILING_CALL", std::to_string(n).c_str(), 1);
            const Outcome outcome = render(what);
            const std::string which = "call " + std::to_string(n) + " of " + std::to_string(calls.count);
            EXPECT_EQ(outcome.signal, 0) << which << " crashes or hangs: " << outcome.err;
            if (outcome.signal != 0)
                continue;
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
        RecordProperty("calls", std::to_string(calls.count));
        RecordProperty("failed", std::to_string(failed));
        std::printf("%s: %ld calls, %zu failed in turn, %ld renders ended with an error\n", what.method.c_str(),
                    calls.count, chosen.size(), failed);
        EXPECT_GT(failed, 0);
    }
};

TEST_F(FailingCalls, SomeCallsOfPathTracing) {
    fail_calls({"pt"}, [](const Calls &calls) {
        std::vector<long> some;
        for (long n = 1; n <= calls.count; n += calls.count / 7)
            some.push_back(n);
        return some;
    });
}

/// PoCL keeps the lock that each release of a program takes: nothing is released, or the render would not end.
TEST_F(FailingCalls, ExceptionsOfTheCompiler) {
    EXPECT_EQ(render({"pt"}).exit_code, 0);
    for (const char *build : {"1", "4"}) {
        ::setenv("GRADUS_TEST_THROWING_BUILD", build, 1);
        const Outcome outcome = render({"pt"});
        EXPECT_EQ(outcome.exit_code, 4) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("gradus: error: out of memory")) << build;
    }
}

/// A device that does not say what it is takes none of those beside it along.
TEST_F(FailingCalls, WhatOneDeviceDoesNotTell) {
    ::setenv("POCL_DEVICES", "basic pthread", 1);
    const auto devices = [&] {
        std::istringstream text(run({"devices"}).out);
        int count = 0;
        for (std::string line; std::getline(text, line);)
            count += line.starts_with("   platform ");
        return count;
    };
    const int all = devices();
    if (all < 2)
        GTEST_SKIP() << "only PoCL has two devices";
    // The calls before are for the platform, and the first description makes some twenty.
    ::setenv("GRADUS_TEST_FAILING_CALL", "12", 1);
    EXPECT_EQ(devices(), all - 1);
}

/// Of which each takes half an hour.
class FullFailingCalls : public FailingCalls {};
TEST_F(FullFailingCalls, EachCallOfPathTracing) { fail_calls({"pt"}, each); }

class FullFailingCallsOfOnePixel : public FailingCalls {};
TEST_F(FullFailingCallsOfOnePixel, EachCallOfGradientDomainPathTracing) { fail_calls({"gpt", "1x1"}, each); }

/// Of 22,000 calls, which is mostly what iterations of the solver repeat, on the levels that more pixels have.
class FullFailingCallsByPlace : public FailingCalls {};
TEST_F(FullFailingCallsByPlace, FirstAndLastOfGradientDomainPathTracing) { fail_calls({"gpt"}, by_place); }

/// An address space from too small for anything to large enough: an error that says so, or the whole image.
TEST_F(FullFailingCalls, MemoryForAnyPartOfTheRender) {
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
TEST_F(FullFailingCalls, MemoryForAnyNumberOfThreads) {
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

} // namespace
} // namespace gradus
