// The command line: help, versions, mistakes, and the small commands.
#include "runtime/io/image_io.h"
#include "tests/driver/child_process.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gradus {
namespace {

using ::testing::HasSubstr;

using CommandLine = ProgramTest;

TEST_F(CommandLine, HelpAndVersion) {
    EXPECT_EQ(run({"--version"}).out, "gradus 0.1.0\n");
    const Outcome help = run({"--help"});
    EXPECT_EQ(help.exit_code, 0);
    for (const char *word : {"render", "inspect", "plugins", "devices", "compare", "solve", "warm", "Examples:", "130"})
        EXPECT_THAT(help.out, HasSubstr(word));
    const Outcome render = run({"render", "--help"});
    EXPECT_EQ(render.exit_code, 0);
    for (const char *option :
         {"--method",       "--spp",        "--time",     "--seed",   "--size",        "--crop",
          "--max-depth",    "--rr-depth",   "--nthreads", "--device", "--batch-size",  "--define",
          "--strict",       "--quiet",      "--stats",    "--aov",    "--png",         "--write-partial",
          "--dump-kernels", "--all-traits", "--strategy", "--error",  "--until-error", "--no-variance"})
        EXPECT_THAT(render.out, HasSubstr(option));
    const Outcome solve = run({"solve", "--help"});
    for (const char *option : {"--primal",
                               "--dx",
                               "--dy",
                               "--direct",
                               "--layers",
                               "--layer ",
                               "--variance-primal",
                               "--variance-dx",
                               "--variance-dy",
                               "--output",
                               "--png",
                               "--stats",
                               "--quiet",
                               "--norm",
                               "--alpha",
                               "--weights",
                               "--per-channel",
                               "--no-mean-correction",
                               "--method",
                               "--tolerance",
                               "--iterations",
                               "--damping",
                               "--device",
                               "--nthreads",
                               "l1   least",
                               "l2   least",
                               "Examples:",
                               "very_direct",
                               "--reconstruction"})
        EXPECT_THAT(solve.out, HasSubstr(option));
    for (const char *command : {"inspect", "devices", "compare", "solve", "warm"})
        EXPECT_EQ(run({command, "--help"}).exit_code, 0) << command;
}

TEST_F(CommandLine, OptionsMayStandAnywhereAndDefinitionsTakeOneWordEach) {
    EXPECT_EQ(run({"render", "-D", "a=1", "scene.xml", "-Db=2", "-o", "out.exr", "--max-depth", "-1", "-D", "c=x=y"})
                  .exit_code,
              0);
}

/// As `seq -w` writes them.
TEST_F(CommandLine, WholeNumbersAreDecimal) {
    ASSERT_EQ(run({"render", "scene.xml", "-o", "out.exr", "--seed", "010", "--spp", "08"}).exit_code, 0);
    const Image image = read_image(at("out.exr"));
    EXPECT_EQ(image.metadata.at("seed"), "10");
    EXPECT_EQ(image.metadata.at("spp"), "8");
}

TEST_F(CommandLine, InspectPrintsSceneAndTraits) {
    const Outcome text = run({"inspect", "scene.xml", "--size", "32x16"});
    EXPECT_EQ(text.exit_code, 0) << text.err;
    EXPECT_THAT(text.out, HasSubstr("32x16"));
    EXPECT_THAT(text.out, HasSubstr("HAS_DIFFUSE = 1"));
    const nlohmann::json json = nlohmann::json::parse(run({"inspect", "scene.xml", "--json"}).out);
    EXPECT_EQ(json.at("film").at("width"), 8);
    EXPECT_EQ(json.at("traits").at("HAS_CONSTANT"), 0);
    EXPECT_EQ(run({"inspect", "none.xml"}).exit_code, 3);
}

TEST_F(CommandLine, DevicesSaysWhatToDoWhereThereIsNone) {
    const Outcome outcome = run({"devices"});
    EXPECT_EQ(outcome.exit_code, 4);
    EXPECT_THAT(outcome.err, HasSubstr("pocl-opencl-icd"));
    EXPECT_EQ(nlohmann::json::parse(run({"devices", "--json"}).out), nlohmann::json::array());
}

TEST_F(CommandLine, WarmNamesTheKernels) {
    const Outcome outcome = run({"warm", "scene.xml"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("0.250 s  fake_kernel (1 of 1)"));
    EXPECT_THAT(files(), ::testing::ElementsAre("scene.xml"));
    // Renders do without a cache, but to warm none is no success.
    for (const auto &[folder, exit_code] : {std::pair{"", 2}, {"/proc/no-such-folder", 5}}) {
        setenv("FAKE_CACHE", folder, 1);
        EXPECT_EQ(run({"warm", "scene.xml"}).exit_code, exit_code) << folder;
    }
    unsetenv("FAKE_CACHE");
    // A full disk ends it, and is no error of a render, which says why it will be slow again.
    setenv("FAKE_FULL_DISK", "yes", 1);
    EXPECT_EQ(run({"warm", "scene.xml"}).exit_code, 5);
    const Outcome render = run({"render", "scene.xml", "-o", "out.exr"});
    EXPECT_EQ(render.exit_code, 0);
    EXPECT_THAT(render.err, HasSubstr("not all kernels could be kept"));
    unsetenv("FAKE_FULL_DISK");
    // What a render would refuse or warn of.
    EXPECT_EQ(run({"warm", "scene.xml", "--method", "pt", "--alpha", "0.5"}).exit_code, 2);
    EXPECT_EQ(run({"warm", "scene.xml", "--guide", "filter"}).exit_code, 2);
    EXPECT_EQ(run({"warm", "scene.xml", "--size", "65536x65536"}).exit_code, 4);
    EXPECT_THAT(run({"warm", "scene.xml", "--photons", "5"}).err, HasSubstr("--photons changes nothing with gpt"));
}

} // namespace
} // namespace gradus
