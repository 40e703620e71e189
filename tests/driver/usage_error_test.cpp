// Mistakes on the command line, inside this process: starting one for each would take most of the tests' time.
#include "driver/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace gradus {
namespace {

/// Runs the program with services that must not be reached, and returns its exit code.
int run(const std::vector<std::string> &arguments) {
    Services services;
    services.method_names = [] { return std::vector<std::string>{"pt"}; };
    services.load_scene = [](const std::string &, const LoadOptions &) -> LoadedScene {
        LoadedScene loaded;
        loaded.scene.film.width = loaded.scene.film.height = 8;
        return loaded;
    };
    services.prepare = [](const std::string &, const std::string &, const Scene &,
                          const RenderOptions &) -> PreparedMethod { throw std::logic_error("a render began"); };
    std::vector<const char *> words{"gradus"};
    for (const std::string &argument : arguments)
        words.push_back(argument.c_str());
    return run_program(int(words.size()), words.data(), services);
}

TEST(UsageErrors, HaveTheirExitCodeAndAMessage) {
    const std::string output = ::testing::TempDir() + "gradus-usage-error.exr";
    const std::vector<std::vector<std::string>> cases = {{},
                                                         {"paint"},
                                                         {"render"},
                                                         {"render", "scene.xml"},
                                                         {"--spp", "0"},
                                                         {"--spp", "-3"},
                                                         {"--spp", "many"},
                                                         {"--seed", "-1"},
                                                         {"--seed", "1.5"},
                                                         {"--seed", "18446744073709551616"},
                                                         {"--spp", "0x10"},
                                                         {"--time", "nan"},
                                                         {"--write-partial", "nan"},
                                                         {"--write-partial", "inf"},
                                                         {"--shift-threshold", "nan"},
                                                         {"--shift-distance", "1.5"},
                                                         {"--gather-roughness", "nan"},
                                                         {"--alpha", "1e300"},
                                                         {"--reconstruction", "l1", "--alpha", "1e-5"},
                                                         {"--method", "pt", "--alpha", "0.5"},
                                                         {"--guide", "filter"},
                                                         {"--time", "0"},
                                                         {"--time", "-1"},
                                                         {"--until-error", "0"},
                                                         {"--until-error", "-1"},
                                                         {"--until-error", "nan"},
                                                         {"--until-error", "inf"},
                                                         {"--until-error", "0.01x"},
                                                         {"--size", "640"},
                                                         {"--size", "0x10"},
                                                         {"--size", "10x10x10"},
                                                         {"--crop", "1,2,3"},
                                                         {"--crop", "-1,0,2,2"},
                                                         {"--crop", "0,0,0,2"},
                                                         {"--max-depth", "0"},
                                                         {"--max-depth", "-2"},
                                                         {"--rr-depth", "0"},
                                                         {"--nthreads", "-1"},
                                                         {"--method", "magic"},
                                                         {"--strategy", "luck"},
                                                         {"--precision", "half"},
                                                         {"-D", "novalue"},
                                                         {"--write-partial", "0"},
                                                         {"--unknown"},
                                                         {"second.xml"}};
    for (std::vector<std::string> arguments : cases) {
        const std::string name = arguments.empty() ? "nothing" : arguments[0] + " " + arguments.back();
        if (!arguments.empty() && arguments[0] != "render" && arguments[0] != "paint")
            arguments.insert(arguments.begin(), {"render", "scene.xml", "-o", output});
        ::testing::internal::CaptureStderr();
        const int exit_code = run(arguments);
        const std::string message = ::testing::internal::GetCapturedStderr();
        EXPECT_EQ(exit_code, 2) << name << ": " << message;
        EXPECT_THAT(message, ::testing::StartsWith("gradus: error: ")) << name;
    }
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({"render", "scene.xml", "-o", output}), 1) << "without a mistake the render begins";
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("a render began"));
}

TEST(UsageErrors, NameWhatDoesNotExistAndWhatMayHaveBeenMeant) {
    const struct {
        std::vector<std::string> arguments;
        const char *message;
    } cases[] = {
        {{"rendr", "scene.xml"}, "rendr is no command; did you mean render? The commands are render, inspect"},
        {{"--spp", "4"}, "--spp comes before a command, which is one of render, inspect"},
        {{"render", "scene.xml", "-o", "a.exr", "--sppp", "4", "--methd", "pt"},
         "--sppp is not an option of render; did you mean --spp?"},
        {{"render", "scene.xml", "-o", "a.exr", "--nothing-of-the-kind=3"},
         "--nothing-of-the-kind is not an option of render\n"},
        {{"warm", "scene.xml", "-o", "a.exr"}, "-o is not an option of warm, but of render, solve\n"},
        {{"render", "scene.xml", "-o", "a.exr", "--json=-"},
         "--json is not an option of render, but of inspect, devices, compare\n"},
        {{"render", "scene.xml", "-o", "a.exr", "--", "--spp", "4"},
         "--spp comes after --, where no word is an option\n"},
        {{"render", "scene.xml", "second.xml", "-o", "a.exr"}, "render takes no more, but was given: second.xml"}};
    for (const auto &[arguments, message] : cases) {
        ::testing::internal::CaptureStderr();
        EXPECT_EQ(run(arguments), 2);
        EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr(message));
    }
}

TEST(UsageErrors, WordsAreThoseOfTheHelp) {
    const struct {
        std::vector<std::string> arguments;
        const char *message;
    } cases[] = {{{"inspect", "scene.xml", "--instances", "none"}, "--instances: none not in {auto,copies,kept}"},
                 {{"inspect", "scene.xml", "--instances", "1"}, "--instances: 1 not in {auto,copies,kept}"},
                 {{"render", "scene.xml", "-o", "a.exr", "--direct", "both"}, "--direct: both not in {sample,photons}"},
                 {{"solve", "a.exr", "-o", "b.exr", "--weights", "mine"}, "--weights: mine not in {uniform,variance}"},
                 {{"solve", "a.exr", "-o", "b.exr", "--norm", "l3"}, "--norm: l3 not in {"}};
    for (const auto &[arguments, message] : cases) {
        ::testing::internal::CaptureStderr();
        EXPECT_EQ(run(arguments), 2);
        EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr(message));
    }
}

/// What a scene is loaded with and rendered by, where a render has these options.
std::pair<InstanceChoice, RenderOptions> asked_for(const std::vector<std::string> &options) {
    std::pair<InstanceChoice, RenderOptions> asked;
    Services services;
    services.method_names = [] { return std::vector<std::string>{"gpt", "sppm"}; };
    services.load_scene = [&](const std::string &, const LoadOptions &load) {
        asked.first = load.instances;
        LoadedScene loaded;
        loaded.scene.film.width = loaded.scene.film.height = 8;
        return loaded;
    };
    services.prepare = [&](const std::string &, const std::string &, const Scene &,
                           const RenderOptions &render) -> PreparedMethod {
        asked.second = render;
        throw std::logic_error("a render began");
    };
    const std::string output = ::testing::TempDir() + "gradus-words.exr";
    std::vector<const char *> words{"gradus", "render", "scene.xml", "-o", output.c_str(), "--quiet"};
    for (const std::string &option : options)
        words.push_back(option.c_str());
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run_program(int(words.size()), words.data(), services), 1);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("a render began"));
    return asked;
}

TEST(WordOptions, SayWhatIsMeant) {
    const auto [standard_instances, standard] = asked_for({});
    EXPECT_EQ(standard_instances, InstanceChoice::automatic);
    EXPECT_FALSE(standard.direct_photons);
    EXPECT_EQ(standard.reconstruction, Reconstruction::weighted);
    EXPECT_EQ(asked_for({"--instances", "copies"}).first, InstanceChoice::copies);
    EXPECT_EQ(asked_for({"--instances", "kept"}).first, InstanceChoice::kept);
    EXPECT_TRUE(asked_for({"--method", "sppm", "--direct", "photons"}).second.direct_photons);
    EXPECT_FALSE(asked_for({"--method", "sppm", "--direct", "sample"}).second.direct_photons);
    EXPECT_EQ(asked_for({"--norm", "l2"}).second.reconstruction, Reconstruction::l2);
    EXPECT_EQ(asked_for({"--norm", "L1"}).second.reconstruction, Reconstruction::l1);
}

/// As of variables that are not set: an empty folder would be the working one, and a file that nobody reads or writes.
TEST(UsageErrors, ValuesMustNotBeEmpty) {
    const std::string output = ::testing::TempDir() + "gradus-usage-error.exr";
    const std::vector<std::string> render{"render", "scene.xml", "-o", output, "--confined"};
    const std::vector<std::string> compare{"compare", "a.exr", "b.exr"}, solve{"solve", "a.exr", "-o", "b.exr"};
    const std::pair<std::vector<std::string>, std::vector<std::string>> cases[] = {
        {render, {"--allow", "--stats", "--dump-kernels", "--device"}},
        {compare, {"--json", "--error-image", "--variance", "--layer"}},
        {solve, {"--stats", "--primal", "--dx", "--direct", "--variance-primal"}}};
    for (const auto &[call, options] : cases)
        for (const std::string &option : options) {
            std::vector<std::string> words = call;
            words.insert(words.end(), {option, ""});
            ::testing::internal::CaptureStderr();
            EXPECT_EQ(run(words), 2) << option;
            EXPECT_THAT(::testing::internal::GetCapturedStderr(),
                        ::testing::HasSubstr("gradus: error: " + option + ": must not be empty\n"));
        }
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(run({"solve", "", "-o", "b.exr"}), 2);
    EXPECT_THAT(::testing::internal::GetCapturedStderr(), ::testing::HasSubstr("must not be empty"));
}

} // namespace
} // namespace gradus
