// Building kernels and launching them.
#include "runtime/device/kernel_source.h"
#include "runtime/device/launch_observer.h"
#include "runtime/device/opencl.h"
#include "runtime/device/program.h"
#include "runtime/error.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <unistd.h>

namespace gradus {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// The stage that needs least: it sums up the counts of chunks.
const KernelRequest scan = {
    "partition scan", "kernels/stages/partition.cl", "partition_scan", {{"PARTITION_CHUNK", "4"}}};

class Program : public ::testing::Test {
  protected:
    Device device;
    KernelLibrary library{device, {}};
};

TEST_F(Program, LaunchesWithArgumentsByName) {
    Kernel kernel = library.build({scan})[0];
    EXPECT_EQ(kernel.name(), "partition scan");
    const std::vector<std::uint32_t> counts = {3, 1, 4, 1, 5, 9};
    constexpr std::uint32_t canary = 0xC0FFEE;
    const std::vector<std::uint32_t> canaries(8, canary);
    const Buffer offset(device, "chunk_offset", counts.data(), 24), range(device, "range", canaries.data(), 32);
    kernel.bind(offset);
    kernel.bind(range);
    kernel.set("count", 1);
    kernel.set("bins", 3);
    kernel.set("chunks", 2);
    kernel.set("no_such_argument", 5); // left out in silence
    kernel.launch(1);
    std::vector<std::uint32_t> result(8);
    range.read(result.data(), 32);
    EXPECT_THAT(result, ::testing::ElementsAre(0, 4, 9, 23, canary, canary, canary, canary));
}

// Who lends the host's memory lets it go after the buffer, and may not have waited: an interrupted render.
TEST_F(Program, HasEndedWhereTheHostsMemoryGoes) {
    if (!device.description().shares_memory)
        GTEST_SKIP() << "the device copies the host's memory";
    constexpr std::uint32_t chunks = 1u << 24;
    std::vector<std::uint32_t> counts(chunks, 1);
    Kernel kernel = library.build({scan})[0];
    const Buffer range(device, "range", 64);
    {
        const Buffer offset = Buffer::over(device, "chunk_offset", counts.data(), counts.size() * sizeof(counts[0]));
        kernel.bind(offset);
        kernel.bind(range);
        kernel.set("count", 1);
        kernel.set("bins", 1);
        kernel.set("chunks", chunks);
        kernel.launch(1);
    }
    const std::vector<std::uint32_t> seen = counts; // the sums of those before
    EXPECT_EQ(seen.back(), chunks - 1);
    finish(device);
}

TEST_F(Program, TellsAnObserverOfLaunchesAndNotOfItsOwn) {
    std::vector<std::string> seen;
    const Buffer offset(device, "chunk_offset", 64), range(device, "range", 64);
    const auto launch = [&] {
        Kernel kernel = library.build({scan})[0];
        kernel.bind(offset);
        kernel.bind(range);
        kernel.set("count", 1);
        kernel.set("bins", 1);
        kernel.set("chunks", 3);
        kernel.launch(1);
    };
    observe_launches(device, [&](const Launch &seen_launch) {
        seen.push_back(seen_launch.request.name);
        EXPECT_EQ(seen_launch.items, 1u);
        EXPECT_EQ(std::get<std::uint32_t>(seen_launch.arguments.at("chunks").value), 3u);
        EXPECT_EQ(std::get<Buffer>(seen_launch.arguments.at("range").value).bytes(), range.bytes());
        EXPECT_TRUE(seen_launch.arguments.at("range").type.starts_with("uint"));
        launch();
    });
    launch();
    launch();
    EXPECT_EQ(seen.size(), 2u);
    observe_launches(device, {});
    launch();
    EXPECT_EQ(seen.size(), 2u);
}

TEST_F(Program, WillNotLaunchWithoutAnArgument) {
    Kernel kernel = library.build({scan})[0];
    const Buffer offset(device, "chunk_offset", 64), range(device, "range", 64);
    kernel.bind(offset);
    kernel.set("count", 1);
    kernel.set("bins", 1);
    kernel.set("chunks", 1);
    try {
        kernel.launch(1);
        FAIL() << "launched without its range";
    } catch (const std::logic_error &error) {
        EXPECT_THAT(error.what(), HasSubstr("partition scan"));
        EXPECT_THAT(error.what(), HasSubstr("range"));
    }
    kernel.bind(range);
    EXPECT_NO_THROW(kernel.launch(1));
}

TEST_F(Program, CountsItsLaunches) {
    Kernel kernel = library.build({scan})[0];
    const std::vector<std::uint32_t> zeros(64);
    const Buffer offset(device, "chunk_offset", zeros.data(), 256), range(device, "range", 256);
    kernel.bind(offset);
    kernel.bind(range);
    kernel.set("count", 1);
    kernel.set("bins", 1);
    kernel.set("chunks", 1);
    for (int i = 0; i < 300; ++i)
        kernel.launch(7);
    kernel.launch(0); // nothing to do
    const Kernel::Usage usage = kernel.usage();
    EXPECT_EQ(usage.launches, 300u);
    EXPECT_EQ(usage.items, 2100u);
    EXPECT_GT(usage.seconds, 0);
    kernel.reset_usage();
    EXPECT_EQ(kernel.usage().launches, 0u);
    EXPECT_EQ(kernel.usage().seconds, 0);
}

TEST_F(Program, ThatDoesNotCompileIsNamedWithTheCompilersLog) {
    KernelRequest broken = {
        "shade broken", "kernels/stages/shade.cl", "shade", {{"BSDF", "nonsense"}, {"BSDF_IS_DIRAC", "0"}}};
    try {
        library.build({broken});
        FAIL();
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), HasSubstr("shade broken"));
        EXPECT_THAT(error.what(), HasSubstr("nonsense_sample"));
        EXPECT_THAT(error.what(), HasSubstr("kernels/stages/shade_vertex.h")) << "the real file, by #line";
    }
}

TEST_F(Program, InDoubleNeedsADeviceThatHasIt) {
    device.implementation().description.has_double = false;
    EXPECT_NO_THROW(KernelLibrary(device, {}, Precision::single));
    try {
        KernelLibrary(device, {}, Precision::double_);
        FAIL();
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), HasSubstr("has no double precision"));
    }
}

// What counts on rounding is compiled as ever: no option of the compiler relaxes it.
TEST_F(Program, ThatIsStrictIsNeverRelaxed) {
    const std::string folder = ::testing::TempDir() + "gradus-strict-" + std::to_string(getpid());
    KernelRequest relaxed = scan, strict = scan;
    strict.name = "strict";
    strict.strict = true;
    KernelLibrary(device, {}, Precision::relaxed).build({relaxed, strict}, {}, folder);
    const auto first_line = [&](const char *file) {
        std::ifstream in(std::filesystem::path(folder) / file);
        std::string line;
        std::getline(in, line);
        return line;
    };
    EXPECT_THAT(first_line("partition-scan.cl"), HasSubstr("-cl-fast-relaxed-math"));
    EXPECT_THAT(first_line("strict.cl"), HasSubstr("-cl-single-precision-constant"));
    EXPECT_THAT(first_line("strict.cl"), Not(HasSubstr("relaxed")));
    std::filesystem::remove_all(folder);
}

TEST_F(Program, ReportsEachKernelThatIsBuilt) {
    std::vector<KernelRequest> requests(3, scan);
    for (std::size_t i = 0; i < requests.size(); ++i)
        requests[i].name = "scan " + std::to_string(i);
    std::size_t calls = 0;
    const std::vector<Kernel> kernels =
        library.build(requests, [&](const std::string &, std::size_t built, std::size_t of, double seconds) {
            EXPECT_EQ(built, ++calls);
            EXPECT_EQ(of, 3u);
            EXPECT_GE(seconds, 0);
        });
    EXPECT_EQ(calls, 3u);
    for (std::size_t i = 0; i < requests.size(); ++i)
        EXPECT_EQ(kernels[i].name(), requests[i].name) << "in the order of the requests";
}

// What a kernel is compiled for is what it declares, and nothing else.
TEST_F(Program, IsCompiledForTheTraitsThatItDeclares) {
    KernelLibrary with_traits(device, {{"TRAIT_AOV", 1}, {"TRAIT_SPHERES", 1}});
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("gradus-dump-" + std::to_string(getpid()));
    with_traits.build({{"accumulate", "kernels/stages/accumulate.cl", "accumulate", {}}}, {}, folder.string());
    std::ifstream file(folder / "accumulate.cl");
    std::string options;
    std::getline(file, options);
    std::ostringstream rest;
    rest << file.rdbuf();
    std::filesystem::remove_all(folder);
    EXPECT_THAT(options, HasSubstr("-D TRAIT_AOV=1"));
    EXPECT_THAT(options, Not(HasSubstr("TRAIT_SPHERES")));
    EXPECT_EQ(rest.str(), kernel_source("kernels/stages/accumulate.cl").text);
}

} // namespace
} // namespace gradus
