// Compilers that tests share: their code is that of a compiler of one's own, and nothing of them stays.
#include "runtime/device/compile_workers.h"
#include "runtime/device/opencl.h"
#include "runtime/device/program_code.h"
#include "runtime/device/program_image.h"
#include "tests/support/pattern.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <thread>

namespace gradus {
namespace {

namespace fs = std::filesystem;

constexpr const char *shared = GRADUS_SHARED_COMPILE;

/// Servers of this test: their variables tell them from those of others.
std::set<std::string> servers() {
    std::set<std::string> found;
    std::error_code failure;
    for (fs::directory_iterator entry("/proc", failure), end; !failure && entry != end; entry.increment(failure)) {
        std::error_code ignored;
        if (fs::read_symlink(entry->path() / "exe", ignored) != fs::path(shared))
            continue;
        std::ifstream file(entry->path() / "environ", std::ios::binary);
        const std::string variables{std::istreambuf_iterator<char>(file), {}};
        std::ifstream parts(entry->path() / "stat");
        const std::string state{std::istreambuf_iterator<char>(parts), {}};
        // The process that hands its socket over is in the session of this test, the server is the first of its own.
        static const testing::Pattern of_stat("^([0-9]+) .*\\) [A-Y] [0-9]+ [0-9]+ ([0-9]+) ");
        const std::vector<testing::Pattern::Match> fields = of_stat.all_in(state);
        if (variables.find(std::string("GRADUS_TEST_OF_COMPILERS=") + std::to_string(getpid())) != std::string::npos &&
            !fields.empty() && fields[0][1] == fields[0][2])
            found.insert(fields[0][1]);
    }
    return found;
}

class SharedCompile : public ::testing::Test {
  protected:
    void SetUp() override {
        if (!is_pocl_cpu(device.description()))
            GTEST_SKIP() << "only PoCL has workers";
        setenv("GRADUS_SHARED_COMPILE_SECONDS", "2", 1);
        setenv("GRADUS_TEST_OF_COMPILERS", std::to_string(getpid()).c_str(), 1);
    }
    void TearDown() override {
        for (const char *name : {"GRADUS_COMPILE", "GRADUS_SHARED_COMPILE_SECONDS", "GRADUS_TEST_OF_COMPILERS"})
            unsetenv(name);
    }

    /// Code by the compilers of a program, without the name of the file that PoCL had the source in.
    std::string code(const std::string &program, const std::string &text) {
        setenv("GRADUS_COMPILE", program.c_str(), 1);
        const CompileJob job = {device.description(), {"add", text, "-cl-std=CL1.2 -cl-kernel-arg-info"}};
        CompileAnswer answer;
        CompileWorkers().compile({job}, 64, 1, [&](std::size_t, const CompileAnswer &given) { answer = given; });
        if (answer.kind != CompileAnswer::Kind::compiled)
            return "";
        return program_image(answer.content).binary;
    }

    Device device;
};

const std::string sum = "__kernel void add(__global float *a) { a[get_global_id(0)] += 1; }";

TEST_F(SharedCompile, IsOneServerWhoseCodeIsThatOfAWorkerOfOnesOwn) {
    const std::string own = code(compile_worker_program(), sum);
    ASSERT_FALSE(own.empty());
    std::set<std::string> seen;
    for (int user = 0; user < 3; ++user) {
        const std::string of_others = code(shared, sum);
        ASSERT_EQ(of_others.size(), own.size());
        // PoCL's intermediate code holds the name of the source's file: some 20 characters.
        std::size_t other_bytes = 0;
        for (std::size_t i = 0; i < own.size(); ++i)
            other_bytes += own[i] != of_others[i];
        EXPECT_LE(other_bytes, 100u);
        seen.merge(servers());
    }
    EXPECT_EQ(seen.size(), 1u) << "each user had a server of its own";
}

TEST_F(SharedCompile, TellsWhatDoesNotCompile) {
    setenv("GRADUS_COMPILE", shared, 1);
    const CompileJob job = {device.description(), {"bad", "__kernel void bad() { nothing(); }", "-cl-std=CL1.2"}};
    CompileAnswer answer;
    CompileWorkers().compile({job}, 64, 1, [&](std::size_t, const CompileAnswer &given) { answer = given; });
    EXPECT_EQ(answer.kind, CompileAnswer::Kind::does_not_compile);
    EXPECT_NE(answer.content.find("nothing"), std::string::npos) << answer.content;
}

TEST_F(SharedCompile, LeavesNothing) {
    ASSERT_FALSE(code(shared, sum).empty());
    ASSERT_EQ(servers().size(), 1u);
    const auto start = std::chrono::steady_clock::now();
    while (!servers().empty() && std::chrono::steady_clock::now() - start < std::chrono::seconds(60))
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_TRUE(servers().empty()) << "it should end two seconds after its last user";
}

} // namespace
} // namespace gradus
