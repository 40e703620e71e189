// `gradus solve` inside this process: what the solver is asked for, and every mistake with its exit code.
#include "driver/program.h"
#include "driver/solve_job.h"
#include "runtime/error.h"
#include "runtime/film/metrics.h"
#include "runtime/io/image_io.h"
#include "tests/driver/gradient_images.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>

namespace gradus {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

/// What the solver was asked for.
struct Asked {
    std::string device;
    int threads = -1;
    std::uint32_t width = 0, height = 0, channels = 0;
    PoissonOptions options;
    HostImages images; ///< the pointers are not valid any more; null where there was none
    std::vector<float> primal, dx, dy, direct, dx_variance;
    std::array<std::uint64_t, 2> samples = {}; ///< of halves
};

class SolveOptions : public GradientImagesTest {
  protected:
    struct Result {
        int exit_code;
        std::string out, err;
    };

    std::vector<float> copy(const float *planes) const {
        return planes ? std::vector<float>(planes, planes + asked.width * asked.height * asked.channels)
                      : std::vector<float>();
    }

    Result run(const std::vector<std::string> &arguments) {
        Services services;
        services.method_names = [] { return std::vector<std::string>{"pt"}; };
        services.prepare_solver = [this](const std::string &device, int threads, std::uint32_t width,
                                         std::uint32_t height, std::uint32_t channels) {
            if (prepare_fails)
                prepare_fails();
            asked = {device, threads, width, height, channels, {}, {}, {}, {}, {}, {}, {}, {}};
            PreparedSolver solver;
            solver.description.name = "fake device";
            solver.solve = [this](const HostImages &images, const PoissonOptions &options, float *result) {
                asked.options = options;
                asked.images = images;
                asked.primal = copy(images.primal);
                asked.dx = copy(images.dx);
                asked.dy = copy(images.dy);
                asked.direct = copy(images.direct);
                asked.dx_variance = copy(images.dx_variance);
                for (std::size_t i = 0; i < asked.primal.size(); ++i)
                    result[i] = asked.primal[i] + 0.5f;
                ++solves;
                return report;
            };
            solver.solve_weighted = [this](const HostHalves &halves, float *result) {
                asked.samples = halves.samples;
                std::fill_n(result, asked.width * asked.height * asked.channels, 1.0f);
                return report;
            };
            return solver;
        };
        std::vector<const char *> words{"gradus", "solve"};
        for (const std::string &argument : arguments)
            words.push_back(argument.c_str());
        ::testing::internal::CaptureStdout();
        ::testing::internal::CaptureStderr();
        Result result;
        result.exit_code = run_program(int(words.size()), words.data(), services);
        result.out = ::testing::internal::GetCapturedStdout();
        result.err = ::testing::internal::GetCapturedStderr();
        return result;
    }
    /// A solve of layers.exr with these options.
    Result solve(std::vector<std::string> options) {
        options.insert(options.begin(), {write_layers("layers.exr"), "-o", at("out.exr")});
        return run(options);
    }
    PoissonOptions options_of(const std::vector<std::string> &options) {
        const Result result = solve(options);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return asked.options;
    }
    std::string write_with_variances() const {
        return write("variances.exr", counting_image(3, 2,
                                                     layers({{"primal", 100},
                                                             {"dx", 200},
                                                             {"dy", 300},
                                                             {"primal_variance", 500},
                                                             {"dx_variance", 600},
                                                             {"dy_variance", 700}})));
    }

    /// Layers of a weighted render of so many samples a pixel; 0: the file does not say.
    std::string write_halves(const std::string &name, int samples) const {
        std::vector<std::pair<std::string, float>> all;
        for (const char *half : {"even", "odd"})
            for (const char *image : {"primal_", "dx_", "dy_"}) {
                all.push_back({std::string(image) + half, 1.0f});
                all.push_back({std::string(image) + half + "_variance", 1.0f});
            }
        Image image = counting_image(3, 2, layers(all));
        if (samples > 0)
            image.metadata["samples"] = std::to_string(6 * samples);
        return write(name, image);
    }

    Asked asked;
    int solves = 0;
    PoissonReport report;
    std::function<void()> prepare_fails;
};

TEST_F(SolveOptions, ImagesReachTheSolverAsPlanes) {
    const Result result = run({"--primal", write_colours("p.exr", 100), "--dx", write_colours("x.exr", 200), "--dy",
                               write_colours("y.exr", 300), "--direct", write_colours("d.exr", 400), "-o",
                               at("out.exr"), "--device", "graphics", "--nthreads", "3"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(asked.device, "graphics");
    EXPECT_EQ(asked.threads, 3);
    EXPECT_EQ(asked.width, 3u);
    EXPECT_EQ(asked.height, 2u);
    EXPECT_EQ(asked.channels, 3u);
    EXPECT_THAT(asked.primal,
                ElementsAre(100, 101, 102, 103, 104, 105, 110, 111, 112, 113, 114, 115, 120, 121, 122, 123, 124, 125));
    EXPECT_EQ(asked.dx.at(6), 210);
    EXPECT_EQ(asked.dy.at(12), 320);
    EXPECT_EQ(asked.direct.at(17), 425);
    EXPECT_EQ(asked.images.start, nullptr);
    EXPECT_EQ(asked.images.primal_variance, nullptr);
    EXPECT_EQ(read_image(at("out.exr")).find("B")->values.at(5), 125.5f);
}

TEST_F(SolveOptions, RepeatsForMeasuring) {
    const std::string layers = write_layers("layers.exr");
    ASSERT_EQ(run({layers, "-o", at("out.exr")}).exit_code, 0);
    EXPECT_EQ(solves, 1);
    ASSERT_EQ(run({layers, "-o", at("out.exr"), "--repeats", "3"}).exit_code, 0);
    EXPECT_EQ(solves, 4);
}

TEST_F(SolveOptions, DefaultsAreTheSolvers) {
    const PoissonOptions options = options_of({}), standard;
    EXPECT_EQ(options.norm, standard.norm);
    EXPECT_EQ(options.norm, PoissonNorm::l1) << "as the help says";
    EXPECT_EQ(options.alpha, 0.2) << "as the help says";
    EXPECT_FALSE(options.alpha_from_variances);
    EXPECT_FALSE(options.weigh_by_variance);
    EXPECT_EQ(options.method, LinearMethod::automatic);
    EXPECT_EQ(options.tolerance, 0);
    EXPECT_EQ(options.iterations, 0);
    EXPECT_EQ(options.inner_iterations, standard.inner_iterations);
    EXPECT_EQ(options.damping, 1);
    EXPECT_TRUE(options.joint_channels);
    EXPECT_TRUE(options.keep_mean);
    EXPECT_EQ(asked.device, "");
    EXPECT_EQ(asked.threads, 0);
    EXPECT_EQ(asked.direct.size(), 0u);
}

TEST_F(SolveOptions, EveryOptionReachesTheSolver) {
    EXPECT_EQ(options_of({"--norm", "L2"}).norm, PoissonNorm::l2);
    EXPECT_EQ(options_of({"--norm", "l2"}).norm, PoissonNorm::l2);
    EXPECT_EQ(options_of({"--norm", "L1"}).norm, PoissonNorm::l1);
    EXPECT_EQ(options_of({"--alpha", "0"}).alpha, 0);
    EXPECT_EQ(options_of({"--alpha", "1.5e-3"}).alpha, 1.5e-3);
    EXPECT_EQ(options_of({"--method", "auto"}).method, LinearMethod::automatic);
    EXPECT_EQ(options_of({"--method", "jacobi"}).method, LinearMethod::jacobi);
    EXPECT_EQ(options_of({"--method", "cg"}).method, LinearMethod::cg);
    EXPECT_EQ(options_of({"--method", "pcg"}).method, LinearMethod::pcg);
    EXPECT_EQ(options_of({"--method", "multigrid"}).method, LinearMethod::multigrid);
    EXPECT_EQ(options_of({"--method", "jacobi", "--damping", "0.75"}).damping, 0.75);
    EXPECT_EQ(options_of({"--tolerance", "1e-7"}).tolerance, 1e-7);
    EXPECT_EQ(options_of({"--iterations", "12"}).iterations, 12);
    EXPECT_FALSE(options_of({"--per-channel"}).joint_channels);
    EXPECT_FALSE(options_of({"--no-mean-correction"}).keep_mean);
    EXPECT_FALSE(options_of({"--weights", "uniform"}).weigh_by_variance);
}

TEST_F(SolveOptions, WhatChangesNothingIsAnError) {
    const std::string path = write_with_variances();
    for (const std::string option : {"--per-channel", "--no-mean-correction"}) {
        const auto outcome = run({path, "-o", at("out.exr"), "--reconstruction", "l2", option});
        EXPECT_EQ(outcome.exit_code, 2) << option;
        EXPECT_THAT(outcome.err, ::testing::HasSubstr(option));
    }
    EXPECT_EQ(
        run({path, "-o", at("out.exr"), "--reconstruction", "l2", "--weights", "variance", "--per-channel"}).exit_code,
        0);
}

TEST_F(SolveOptions, AnImageOfAnotherKindThanTheRendersIsTold) {
    const std::string path = write_with_variances();
    Image layers = read_image(path);
    layers.metadata = {{"reconstruction", "weighted"}};
    write_image(layers, at("of_render.exr"));
    EXPECT_THAT(run({at("of_render.exr"), "-o", at("out.exr")}).err,
                ::testing::HasSubstr("--reconstruction weighted makes its own"));
    EXPECT_EQ(run({at("of_render.exr"), "-o", at("out.exr"), "--reconstruction", "l1"}).err, "");
    EXPECT_EQ(run({path, "-o", at("out.exr")}).err, "");
}

TEST_F(SolveOptions, AnotherAlphaThanTheRendersIsTold) {
    report.converged = true;
    Image layers = read_image(write_with_variances());
    layers.metadata = {{"reconstruction", "l2"}, {"alpha", "0.39557"}};
    const std::string path = write("of_render.exr", layers);
    const std::string own = "--reconstruction l2 --alpha 0.39557 makes its own";
    EXPECT_THAT(run({path, "-o", at("out.exr")}).err, AllOf(HasSubstr("this image is l1"), HasSubstr(own)));
    EXPECT_THAT(run({path, "-o", at("out.exr"), "--reconstruction", "l2"}).err,
                AllOf(HasSubstr("this image is l2 with --alpha 0.2"), HasSubstr(own)));
    EXPECT_THAT(run({path, "-o", at("out.exr"), "--alpha", "0.39557"}).err,
                HasSubstr("--reconstruction l2 makes its own"));
    for (const std::vector<std::string> &chosen :
         std::vector<std::vector<std::string>>{{"--reconstruction", "l2", "--alpha", "0.39557"},
                                               {"--reconstruction", "l2", "--alpha", "0.2"},
                                               {"--reconstruction", "l2", "--alpha", "auto"},
                                               {"--reconstruction", "l1"}}) {
        std::vector<std::string> arguments{path, "-o", at("out.exr")};
        arguments.insert(arguments.end(), chosen.begin(), chosen.end());
        EXPECT_EQ(run(arguments).err, "");
    }
    layers.metadata["alpha"] = "0.2";
    EXPECT_EQ(run({write("of_one_sample.exr", layers), "-o", at("out.exr"), "--reconstruction", "l2"}).err, "");
}

TEST_F(SolveOptions, ValuesWithoutSquaresAreTold) {
    const std::string path = write_with_variances();
    Image layers = read_image(path);
    for (Channel &channel : layers.channels)
        for (float &value : channel.values)
            value *= 1e-18f;
    write_image(layers, at("dark.exr"));
    EXPECT_THAT(run({at("dark.exr"), "-o", at("out.exr")}).err,
                ::testing::HasSubstr("make the lights brighter or darker"));
}

TEST_F(SolveOptions, ValuesWithoutSquaresAreToldOfTheOddHalf) {
    const std::string path = write_halves("halves.exr", 4);
    EXPECT_THAT(run({path, "-o", at("out.exr"), "--reconstruction", "weighted"}).err, Not(HasSubstr("the lights")));
    Image layers = read_image(path);
    for (Channel &channel : layers.channels)
        if (channel.name.starts_with("primal_odd."))
            channel.values.assign(channel.values.size(), 1e-18f);
    write_image(layers, path);
    EXPECT_THAT(run({path, "-o", at("out.exr"), "--reconstruction", "weighted"}).err,
                HasSubstr("make the lights brighter or darker"));
}

/// Of a render that was stopped during its first frame the layers hold 0 where no sample was taken.
TEST_F(SolveOptions, PixelsWithoutSamplesAreMissingAndBlack) {
    Image image = counting_image(3, 2, layers({{"primal", 100}, {"dx", 200}, {"dy", 300}, {"direct", 400}}));
    image.metadata = {{"partial", "true"}, {"samples", "4"}};
    const auto known_of = [](const std::vector<float> &plane) {
        std::vector<std::size_t> known;
        for (std::size_t i = 0; i < plane.size(); ++i)
            if (std::isfinite(plane[i]))
                known.push_back(i);
        return known;
    };
    const auto expect_four = [&] {
        const Result result = run({write("stopped.exr", image), "-o", at("out.exr")});
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_THAT(result.err, HasSubstr("was stopped before each pixel had a sample: the others are black"));
        EXPECT_THAT(known_of(asked.primal), ElementsAre(0, 1, 2, 3, 6, 7, 8, 9, 12, 13, 14, 15));
        EXPECT_EQ(known_of(asked.dx), known_of(asked.primal));
        EXPECT_THAT(known_of(asked.dy), ElementsAre(0, 6, 12));
        EXPECT_THAT(read_image(at("out.exr")).find("G")->values, ElementsAre(110.5f, 111.5f, 112.5f, 113.5f, 0, 0));
    };
    expect_four();
    // Around the image are samples, too, where its filter reaches them: those of the layers are what counts.
    image.metadata["samples"] = "9";
    image.metadata["layer_samples"] = "4";
    expect_four();
    image.metadata["partial"] = "false"; // another program may call something else samples
    image.metadata.erase("layer_samples");
    image.metadata["samples"] = "4";
    EXPECT_THAT(run({write("whole.exr", image), "-o", at("out.exr")}).err, Not(HasSubstr("stopped")));
    EXPECT_EQ(known_of(asked.dy).size(), 18u);
}

TEST_F(SolveOptions, HalvesAreOfTheImagesOwnSamples) {
    Image halves = read_image(write_halves("halves.exr", 5));
    halves.metadata["samples"] = std::to_string(5 * 7 * 6); // with a border of two pixels
    halves.metadata["layer_samples"] = std::to_string(5 * 6);
    ASSERT_EQ(run({write("bordered.exr", halves), "-o", at("out.exr"), "--reconstruction", "weighted"}).exit_code, 0);
    EXPECT_THAT(asked.samples, ElementsAre(3 * 6, 2 * 6));
    halves.metadata["layer_samples"] = std::to_string(3 * 6);
    EXPECT_EQ(run({write("bordered.exr", halves), "-o", at("out.exr"), "--reconstruction", "weighted"}).exit_code, 6);
}

TEST_F(SolveOptions, TheImageIsWhereItsLayersAre) {
    Image image = counting_image(3, 2, layers({{"primal", 100}, {"dx", 200}, {"dy", 300}}));
    image.origin = PixelPlace{7, -2};
    ASSERT_EQ(run({write("cut.exr", image), "-o", at("out.exr")}).exit_code, 0);
    EXPECT_EQ(read_image(at("out.exr")).origin, image.origin);
}

TEST_F(SolveOptions, VariancesAreReadWhereTheyAreUsed) {
    const std::string path = write_with_variances();
    ASSERT_EQ(run({path, "-o", at("out.exr")}).exit_code, 0);
    EXPECT_EQ(asked.images.dx_variance, nullptr);
    ASSERT_EQ(run({"--layers", path, "-o", at("out.exr"), "--alpha", "auto"}).exit_code, 0);
    EXPECT_TRUE(asked.options.alpha_from_variances);
    EXPECT_FALSE(asked.options.weigh_by_variance);
    EXPECT_EQ(asked.dx_variance.at(0), 600);
    EXPECT_NE(asked.images.primal_variance, nullptr);
    EXPECT_NE(asked.images.dy_variance, nullptr);
    EXPECT_EQ(run({"--layers", path, "-o", at("out.exr"), "--alpha", "auto", "-q"}).err, "");
    Image zero = read_image(at("out.exr"));
    for (Channel &channel : zero.channels)
        channel.values.assign(channel.values.size(), 0);
    const std::string none = write("none.exr", zero);
    const Result of_one_sample = run({path, "-o", at("out.exr"), "--alpha", "auto", "--variance-primal", none,
                                      "--variance-dx", none, "--variance-dy", none});
    EXPECT_EQ(of_one_sample.exit_code, 0);
    EXPECT_THAT(of_one_sample.err, HasSubstr("all variances are 0, as of one sample a pixel: they tell no alpha, so it "
                                             "is 0.2"));
    const std::string own = write_colours("own.exr", 7);
    ASSERT_EQ(run({path, "-o", at("out.exr"), "--norm", "L2", "--weights", "variance", "--variance-dx", own}).exit_code,
              0);
    EXPECT_TRUE(asked.options.weigh_by_variance);
    EXPECT_FALSE(asked.options.alpha_from_variances);
    EXPECT_EQ(asked.dx_variance.at(0), 7);
    const Result unused = run({path, "-o", at("out.exr"), "--variance-dx", own});
    EXPECT_EQ(unused.exit_code, 0);
    EXPECT_THAT(unused.err, HasSubstr("own.exr' is not read: only --alpha auto and --weights variance use variances"));
}

TEST_F(SolveOptions, VariancesThatAreNoneAreTold) {
    Image image = counting_image(3, 2, layers({{"primal", 1}, {"dx", 2}, {"dy", 3}}));
    for (const char *name : {"primal_variance", "dx_variance", "dy_variance"})
        for (const char *color : {"R", "G", "B"})
            image.channels.push_back({std::string(name) + "." + color, std::vector<float>(6, -1)});
    const std::string none = write("none.exr", image);
    const std::vector<std::string> weights{none, "-o", at("out.exr"), "--norm", "L2", "--weights", "variance"};
    const Result by_none = run(weights);
    EXPECT_EQ(by_none.exit_code, 6);
    EXPECT_THAT(by_none.err, HasSubstr("no variance is a number of at least 0"));
    image.channels.back().values = {
        0, 1, 2, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -1};
    write("none.exr", image);
    const Result by_three = run(weights);
    EXPECT_EQ(by_three.exit_code, 0);
    // Of 3 x 2 pixels there are 2 x 2 differences dx and 3 x 1 dy: in the last row is none that counts.
    EXPECT_THAT(by_three.err, HasSubstr("36 of 39 variances are NaN, infinite or below 0"));
    image.channels.back().values = {0, 0, 0, -1, -1, -1};
    write("none.exr", image);
    EXPECT_THAT(run({none, "-o", at("out.exr"), "--alpha", "auto"}).err, HasSubstr("all variances are 0"));
}

TEST_F(SolveOptions, WhatAReconstructionHasNoUseForIsTold) {
    const std::string own = write_colours("own.exr", 7), halves = write_halves("halves.exr", 4);
    const Result result = run({halves, "-o", at("out.exr"), "--reconstruction", "weighted", "--primal", own, "--layer",
                               "dx=gradient", "--variance-dx", own});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.err, HasSubstr("own.exr' is not read: --reconstruction weighted has no use for primal"));
    EXPECT_THAT(result.err, HasSubstr("--layer dx=gradient is not read: --reconstruction weighted has no use for dx"));
    EXPECT_THAT(result.err, HasSubstr("own.exr' is not read: only --alpha auto and --weights variance use variances"));
}

TEST_F(SolveOptions, HalvesOfTooFewSamplesAreRefused) {
    report.converged = true;
    const Result result = run({write_halves("halves.exr", 3), "-o", at("out.exr"), "--reconstruction", "weighted"});
    EXPECT_EQ(result.exit_code, 6);
    EXPECT_THAT(result.err, HasSubstr("weighted needs 4 samples of each pixel, and the render that wrote these layers "
                                      "took 3"));
    EXPECT_EQ(run({write_halves("halves.exr", 4), "-o", at("out.exr"), "--reconstruction", "weighted"}).err, "");
    EXPECT_EQ(asked.samples, (std::array<std::uint64_t, 2>{12, 12}));
    // Where the file does not say, both halves have as many.
    EXPECT_EQ(run({write_halves("halves.exr", 0), "-o", at("out.exr"), "--reconstruction", "weighted"}).err, "");
    EXPECT_EQ(asked.samples, (std::array<std::uint64_t, 2>{1, 1}));
}

TEST_F(SolveOptions, PixelsThatAreMissingAreThoseOfBothHalves) {
    const std::vector<std::string> words{write_halves("halves.exr", 4), "-o", at("out.exr"), "--reconstruction",
                                         "weighted"};
    report.missing_primal = 6; // half of 3 x 2 pixels, twice
    EXPECT_THAT(run(words).err, Not(HasSubstr("no pixel of the primal")));
    report.missing_primal = 12;
    EXPECT_THAT(run(words).err, HasSubstr("no pixel of the primal has a finite value"));
}

TEST_F(SolveOptions, LayersAreNamed) {
    const std::string path = write("named.exr", counting_image(3, 2, layers({{"", 1}, {"a", 2}, {"dy", 3}})));
    ASSERT_EQ(run({"--layer", "primal=", path, "--layer", "dx=a", "-o", at("out.exr")}).exit_code, 0);
    EXPECT_EQ(asked.primal.at(0), 1);
    EXPECT_EQ(asked.dx.at(0), 2);
    EXPECT_EQ(asked.dy.at(0), 3);
}

TEST_F(SolveOptions, GreyImagesGiveAGreyImage) {
    const std::string path =
        write("grey.exr", counting_image(3, 2, {{"primal.Y", 1}, {"primal.A", 9}, {"dx.Y", 2}, {"dy.Y", 3}}));
    ASSERT_EQ(run({path, "-o", at("out.exr"), "--png"}).exit_code, 0);
    EXPECT_EQ(asked.channels, 1u);
    const Image image = read_image(at("out.exr"));
    ASSERT_EQ(image.channels.size(), 1u);
    EXPECT_EQ(image.channels[0].name, "Y");
    EXPECT_EQ(image.channels[0].values.at(5), 6.5f);
    EXPECT_EQ(read_image(at("out.png")).channels.size(), 3u);
}

TEST_F(SolveOptions, MetadataSaysWhatWasDone) {
    report.method = "irls, pcg";
    report.alpha = 0.25;
    report.seconds = 1.5;
    Image image = counting_image(3, 2, layers({{"primal", 100}, {"dx", 200}, {"dy", 300}}));
    image.metadata = {{"seed", "5"}, {"spp", "64"}, {"scene", "a.xml"}, {"method", "gpt"}, {"seconds", "99"}};
    ASSERT_EQ(run({write("rendered.exr", image), "-o", at("out.exr"), "--norm", "L2"}).exit_code, 0);
    const auto metadata = read_image(at("out.exr")).metadata;
    EXPECT_EQ(metadata.at("version"), version());
    EXPECT_EQ(metadata.at("method"), "irls, pcg");
    EXPECT_EQ(metadata.at("norm"), "L2");
    EXPECT_EQ(metadata.at("weights"), "uniform");
    EXPECT_EQ(metadata.at("alpha"), "0.25");
    EXPECT_EQ(metadata.at("device"), "fake device");
    EXPECT_EQ(metadata.at("seconds"), "1.500");
    EXPECT_EQ(metadata.at("seed"), "5") << "of the render, for gradus compare";
    EXPECT_EQ(metadata.at("spp"), "64");
    EXPECT_EQ(metadata.at("scene"), "a.xml");
    EXPECT_EQ(metadata.count("samples"), 0u);
}

TEST_F(SolveOptions, MistakesOfTheCall) {
    const std::string layers = write_layers("layers.exr");
    const std::vector<std::pair<std::vector<std::string>, const char *>> cases = {
        {{"--alpha", "-0.1"}, "'-0.1' is neither a number from 0 to 1e+12 nor auto"},
        {{"--alpha", "nan"}, "'nan' is neither"},
        {{"--alpha", "inf"}, "'inf' is neither"},
        {{"--alpha", "1e999"}, "'1e999' is neither"},
        {{"--alpha", "0.2x"}, "'0.2x' is neither"},
        {{"--alpha", ""}, "'' is neither"},
        {{"--alpha", "automatic"}, "'automatic' is neither"},
        {{"--norm", "L3"}, "--norm"},
        {{"--norm", ""}, "--norm"},
        {{"--method", "dct"}, "there is no method dct: multigrid stands in for it (--method multigrid)"},
        {{"--method", "magic"}, "'magic' is not one of auto, jacobi, cg, pcg, multigrid"},
        {{"--tolerance", "0"}, "'0' is not a number above 0"},
        {{"--tolerance", "nan"}, "'nan' is not a number above 0"},
        {{"--tolerance", "-1e-3"}, "--tolerance"},
        {{"--iterations", "0"}, "--iterations"},
        {{"--iterations", "2.5"}, "--iterations"},
        {{"--method", "jacobi", "--damping", "0"}, "'0' is not above 0 and at most 1"},
        {{"--method", "jacobi", "--damping", "1.1"}, "'1.1' is not above 0"},
        {{"--method", "jacobi", "--damping", "nan"}, "'nan' is not above 0"},
        {{"--damping", "0.5"}, "--damping is for one method: add --method jacobi"},
        {{"--alpha", "1e-5"}, "--alpha 1e-05 is lost in rounding"},
        {{"--weights", "other"}, "--weights"},
        {{"--weights", "variance"}, "--weights variance is for l2: add --reconstruction l2"},
        {{"--layer", "dx"}, "'dx' names no layer: write IMAGE=NAME"},
        {{"--layer", "shadow=Z"}, "'shadow' is none of primal, dx"},
        {{"--nthreads", "-1"}, "--nthreads"},
        {{"--repeats", "0"}, "--repeats"},
        {{"--unknown"}, "--unknown"},
        {{"second.exr"}, "second.exr"}};
    for (const auto &[options, message] : cases) {
        std::vector<std::string> arguments{layers, "-o", at("out.exr")};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Result result = run(arguments);
        EXPECT_EQ(result.exit_code, 2) << options[0] << " " << options.back();
        EXPECT_THAT(result.err + result.out, HasSubstr(message));
    }
    EXPECT_EQ(solves, 0);
    EXPECT_FALSE(std::filesystem::exists(at("out.exr")));
    EXPECT_EQ(run({layers, "-o", at("out.exr")}).exit_code, 0) << "without a mistake it solves";
}

TEST_F(SolveOptions, MistakesOfTheFiles) {
    const std::string layers = write_layers("layers.exr");
    const std::vector<std::tuple<std::vector<std::string>, int, const char *>> cases = {
        {{}, 2, "--output is required"},
        {{"-o", at("out.exr")}, 2, "there is no primal: give --primal FILE, or one file with layers"},
        {{"-o", at("out.exr"), "--primal", layers, "--dx", layers}, 2, "there is no dy: give --dy FILE"},
        {{layers, "-o", at("out.png")}, 2, "must end in .exr"},
        {{layers, "-o", at(".exr")}, 2, "has no name before its ending"},
        {{layers, "-o", layers}, 2, "layers.exr' is a file to read"},
        {{layers, "-o", at("out.exr"), "--direct", write_colours("out.png.exr", 1), "--stats", at("out.png.exr")},
         2,
         "out.png.exr' is a file to read"},
        {{layers, "-o", at("out.exr"), "--stats", at("out.exr")}, 2, "--stats and --output name the same file"},
        {{layers, "-o", at("missing/out.exr")}, 5, "cannot write"},
        {{layers, "-o", at("out.exr"), "--stats", at("missing/out.json")}, 5, "cannot write"},
        {{at("none.exr"), "-o", at("out.exr")}, 6, "none.exr"},
        {{write_text("text.exr", "text"), "-o", at("out.exr")}, 6, "cannot read the image"},
        {{"/dev/null", "-o", at("out.exr")}, 6, "cannot read the image '/dev/null': it is no regular file"},
        {{write_colours("plain.exr", 1), "-o", at("out.exr")}, 6, "has no layer for primal; it has:"},
        {{layers, "-o", at("out.exr"), "--dx", write("small.exr", counting_image(2, 2, colours("", 1)))},
         6,
         "layers.exr' is 3x2, '"},
        {{layers, "-o", at("out.exr"), "--dx", write("grey.exr", counting_image(3, 2, {{"Y", 1}}))},
         6,
         "channels differ"},
        {{layers, "-o", at("out.exr"), "--alpha", "auto"}, 6, "no layer for primal_variance"}};
    for (const auto &[arguments, exit_code, message] : cases) {
        const Result result = run(arguments);
        EXPECT_EQ(result.exit_code, exit_code) << message;
        EXPECT_THAT(result.err + result.out, HasSubstr(message));
    }
    EXPECT_EQ(solves, 0);
    EXPECT_FALSE(std::filesystem::exists(at("out.exr")));
}

TEST_F(SolveOptions, TheDeviceMayBeTooSmall) {
    prepare_fails = [] { throw Error(ExitCode::device, "65536x65536 pixels are too many"); };
    const Result device = solve({});
    EXPECT_EQ(device.exit_code, 4);
    EXPECT_EQ(device.err, "gradus: error: 65536x65536 pixels are too many\n");
    prepare_fails = [] { throw std::bad_alloc(); };
    const Result host = solve({});
    EXPECT_EQ(host.exit_code, 4);
    EXPECT_THAT(host.err, AllOf(HasSubstr("out of memory: the images are too large"), Not(HasSubstr("--batch-size"))));
    EXPECT_FALSE(std::filesystem::exists(at("out.exr")));
}

TEST_F(SolveOptions, ImagesThatFitTheDevice) {
    DeviceDescription device;
    device.name = "a small device";
    device.allocation_bytes = 8 * 4 * 3 * sizeof(float);
    check_images_fit(device, 8, 4, 3);
    EXPECT_THROW(check_images_fit(device, 8, 4, 4), Error);
    try {
        check_images_fit(device, 65536, 65536, 3); // more than 32 bits count
        ADD_FAILURE() << "no error";
    } catch (const Error &error) {
        EXPECT_EQ(error.code, ExitCode::device);
        EXPECT_THAT(error.what(), AllOf(HasSubstr("65536x65536 pixels are too large for a small device"),
                                        HasSubstr("49152 MB each")));
    }
}

TEST_F(SolveOptions, WarnsWhereTheResultIsNotAsAskedFor) {
    report.converged = false;
    EXPECT_THAT(solve({"--norm", "L2"}).err, HasSubstr("warning: the tolerance was not reached"));
    EXPECT_EQ(solve({"--norm", "L2", "--iterations", "3"}).err, "") << "as asked for";
    EXPECT_EQ(solve({"--norm", "L1"}).err, "");
    report.converged = true;
    EXPECT_EQ(solve({"--norm", "L2"}).err, "");
    Image image = counting_image(3, 2, layers({{"primal", 100}, {"dx", 200}, {"dy", 300}}));
    image.channels[0].values[0] = std::numeric_limits<float>::infinity();
    const std::string path = write("infinite.exr", image);
    const Result infinite = run({path, "-o", at("out.exr"), "--quiet"});
    EXPECT_EQ(infinite.exit_code, 1);
    EXPECT_THAT(infinite.err, HasSubstr("error: 1 values of the image are NaN or infinite"));
    EXPECT_EQ(count_non_finite(read_image(at("out.exr"))), 0u);
    report.missing_primal = 6; // pixels, all of them
    EXPECT_THAT(solve({}).err, HasSubstr("warning: no pixel of the primal has a finite value"));
    report.missing_primal = 5;
    EXPECT_EQ(solve({}).err, "");
}

} // namespace
} // namespace gradus
