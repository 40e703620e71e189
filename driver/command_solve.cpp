#include "driver/commands.h"
#include "driver/device_options.h"
#include "driver/limits_option.h"
#include "driver/number_checks.h"
#include "driver/reconstruction_options.h"
#include "driver/solve_job.h"
#include "driver/word_option.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {
namespace {

constexpr const char *notes_of_solve = R"(Examples:
  gradus solve layers.exr -o out.exr                      layers primal, dx, dy, and direct if there is one
  gradus solve --primal p.exr --dx dx.exr --dy dy.exr --direct d.exr -o out.exr
  gradus solve layers.exr -o out.exr --reconstruction l2 --alpha auto     with the layers of `render --layers --aov`
  gradus solve layers.exr -o out.exr --layer primal=noisy --layer dx=d_right --layer dy=d_down

Sought is the image I with the differences Gx to the right and Gy downwards, and near to the primal I0:
  l1   least sum |Dx I - Gx| + |Dy I - Gy| + alpha |I - I0|, |.| over the channels of a pixel. Outliers stay
       where they are, and it looks best. It loses energy; a smooth correction brings local means back to I0's.
  l2   least sum (Dx I - Gx)^2 + (Dy I - Gy)^2 + alpha^2 (I - I0)^2. Linear: without bias where the inputs have none,
       and with the mean of I0. Each outlier leaves a bright and a dark spot.
  weighted
       least sum (Dx I - Gx)^2 / var Gx + (Dy I - Gy)^2 / var Gy + (I - I0)^2 / var I0 of each half of the samples, with
       the variances of the other half, and the mean of both. Without bias where the halves are independent. It needs
       what `gradus render --layers --reconstruction weighted` writes: primal_even, dx_even, dy_even, primal_odd and so
       on, and the variance of each.
  guided
       both halves of weighted, and a filtered image of them where that has less error, by place. It also needs albedo,
       normal and depth, as `gradus render --layers --reconstruction guided` writes them; of path tracing, the halves'
       primal alone.
A small alpha trusts the differences, a large one the primal; auto takes the ratio of their variances.

Methods: multigrid cycles; cg, conjugate gradients; pcg, the same preconditioned by a multigrid cycle; jacobi, which is
slow and there to compare with. auto takes multigrid where all weights are equal, else pcg.

NaN and infinite values of primal, dx and dy are treated as missing and counted. The direct image is added as it is.
Layers of usual names are found in any case: primal or throughput, dx or gradientX, dy or gradientY, direct or
very_direct, primal_variance, dx_variance, dy_variance.)";

const std::map<std::string, LinearMethod> methods{{"auto", LinearMethod::automatic},
                                                  {"jacobi", LinearMethod::jacobi},
                                                  {"cg", LinearMethod::cg},
                                                  {"pcg", LinearMethod::pcg},
                                                  {"multigrid", LinearMethod::multigrid}};

/// A check for CLI11: the complaint about a text, or nothing.
CLI::Validator check(const char *kind, std::function<std::string(std::string &)> complaint) {
    return CLI::Validator(std::move(complaint), kind);
}

std::string complain_about_method(std::string &text) {
    if (text == "dct")
        return "there is no method dct: multigrid stands in for it (--method multigrid)";
    return methods.count(text) ? "" : fmt::format("'{}' is not one of auto, jacobi, cg, pcg, multigrid", text);
}

std::string complain_about_damping(std::string &text) {
    const auto number = finite_number(text);
    return number && *number > 0 && *number <= 1 ? "" : fmt::format("'{}' is not above 0 and at most 1", text);
}

GradientLayer layer_called(const std::string &name) {
    std::vector<std::string> names;
    for (const GradientLayer layer : gradient_layers) {
        if (name == layer_name(layer))
            return layer;
        names.push_back(layer_name(layer));
    }
    throw Error(ExitCode::usage, fmt::format("'{}' is none of {}", name, fmt::join(names, ", ")));
}

/// "dx=NAME"; the name may be empty.
std::pair<GradientLayer, std::string> parse_layer(const std::string &text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
        throw Error(ExitCode::usage, fmt::format("'{}' names no layer: write IMAGE=NAME, as in dx=gradient", text));
    return {layer_called(text.substr(0, equals)), text.substr(equals + 1)};
}

std::string complain_about_layer(std::string &text) {
    try {
        parse_layer(text);
        return "";
    } catch (const Error &error) {
        return error.what();
    }
}

void add_input_options(CLI::App &command, GradientSources &sources) {
    const char *group = "Images";
    command.add_option("LAYERS,--layers", sources.layered, "One file with the images as layers")
        ->type_name("FILE.exr")
        ->group(group);
    const auto add = [&](const char *option, GradientLayer layer, const char *text) {
        command
            .add_option_function<std::string>(
                option, [&sources, layer](const std::string &path) { sources.files[layer] = path; }, text)
            ->type_name("FILE")
            ->group(group);
    };
    add("--primal", GradientLayer::primal, "The image that was sampled, without what the direct image holds");
    add("--dx", GradientLayer::dx, "Differences to the right: (x, y) holds I(x + 1, y) - I(x, y)");
    add("--dy", GradientLayer::dy, "Differences downwards: (x, y) holds I(x, y + 1) - I(x, y)");
    add("--direct", GradientLayer::direct, "Added to the result: light that is seen without noise");
    add("--variance-primal", GradientLayer::primal_variance, "Variance of the primal, by pixel and channel");
    add("--variance-dx", GradientLayer::dx_variance, "Variance of dx");
    add("--variance-dy", GradientLayer::dy_variance, "Variance of dy");
    command
        .add_option_function<std::vector<std::string>>(
            "--layer",
            [&sources](const std::vector<std::string> &texts) {
                for (const std::string &text : texts)
                    sources.names.insert_or_assign(parse_layer(text).first, parse_layer(text).second);
            },
            "Which layer an image is, in whichever file; repeatable. An empty NAME: the channels without a layer")
        ->type_name("IMAGE=NAME")
        ->allow_extra_args(false)
        ->check(check("", complain_about_layer))
        ->group(group);
}

void add_output_options(CLI::App &command, SolveRequest &request) {
    const char *group = "Output";
    command.add_option("-o,--output", request.outputs.image, "Image to write: 32-bit float EXR, replaced in one step")
        ->required()
        ->type_name("FILE.exr")
        ->group(group);
    command.add_flag("--png", request.outputs.png, "Also write a PNG beside it: sRGB curve, exposure 1, clamped")
        ->group(group);
    command
        .add_option("--stats", request.outputs.statistics,
                    "Write everything about the solve as JSON; - is stdout, in place of the text")
        ->type_name("FILE")
        ->group(group);
    command.add_flag("-q,--quiet", request.quiet, "Print errors only")->group(group);
}

void add_problem_options(CLI::App &command, SolveRequest &request) {
    const char *group = "What is solved";
    PoissonOptions &options = request.options;
    add_reconstruction_option(
        command, group, request.reconstruction, [&request, &options](Reconstruction reconstruction) {
            request.reconstruction = reconstruction;
            request.reconstruction_is_given = true;
            options.norm = reconstruction == Reconstruction::l1 ? PoissonNorm::l1 : PoissonNorm::l2;
        });
    add_guide_option(command, group, [&request](Guide guide) { request.guide = guide; });
    add_alpha_option(command, group, "0.2",
                     "Weight of the primal, from 0 (its mean alone) on; auto: from the variances",
                     [&request, &options](std::optional<double> alpha) {
                         request.alpha_is_given = true;
                         options.alpha_from_variances = !alpha;
                         options.alpha = alpha.value_or(options.alpha);
                     });
    add_word_option<bool>(
        command, "--weights", {{"uniform", false}, {"variance", true}}, options.weigh_by_variance,
        [&options](bool by_variance) { options.weigh_by_variance = by_variance; },
        "Of the equations, L2 only: uniform, or variance: by inverse variance, and the mean is not kept")
        ->group(group);
    command
        .add_flag_callback(
            "--per-channel", [&options] { options.joint_channels = false; },
            "L1 and --weights variance: channels apart, where colours may drift; else one weight for all channels of "
            "a pixel")
        ->group(group);
    command
        .add_flag_callback(
            "--no-mean-correction", [&options] { options.keep_mean = false; },
            "L1: leave out the smooth image that brings local means back to the primal's")
        ->group(group);
}

void add_solver_options(CLI::App &command, SolveRequest &request) {
    const char *group = "How it is solved";
    PoissonOptions &options = request.options;
    command
        .add_option_function<std::string>(
            "--method", [&options](const std::string &name) { options.method = methods.at(name); },
            "auto (multigrid for uniform weights, pcg for others), jacobi, cg, pcg (cg with multigrid inside), "
            "multigrid")
        ->type_name("NAME")
        ->check(check("", complain_about_method))
        ->default_str("auto")
        ->group(group);
    command
        .add_option("--tolerance", options.tolerance,
                    "Where to stop. L2: relative residual, 1e-5; L1: relative decrease of the sum by a step, 1e-4")
        ->type_name("NUMBER")
        ->check(positive_number())
        ->group(group);
    command
        .add_option(
            "--iterations", options.iterations,
            "At most so many steps or cycles (L2) or reweightings (L1); else what the tolerance takes as a rule")
        ->type_name("N")
        ->transform(whole_number_between(1, 1 << 30))
        ->group(group);
    command.add_option("--damping", request.damping, "Of jacobi, above 0 and at most 1, which is the plain method")
        ->type_name("NUMBER")
        ->check(check("", complain_about_damping))
        ->group(group);
    add_device_options(command, group, request.device, request.threads);
    command
        .add_option("--repeats", request.repeats,
                    "Solve so often, for measuring: the figures are the last one's, without compiling")
        ->transform(whole_number_between(1, 1000))
        ->capture_default_str()
        ->group(group);
}

} // namespace

void add_solve_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command =
        *app.add_subcommand("solve", "Reconstruct an image from a primal image and its gradients (screened Poisson)");
    const auto request = std::make_shared<SolveRequest>();
    command.footer(notes_of_solve);
    add_input_options(command, request->sources);
    add_limits_option(command, request->sources.limits, "Images");
    add_output_options(command, *request);
    add_problem_options(command, *request);
    add_solver_options(command, *request);
    command.callback(
        [request, &services, &chosen] { chosen = [request, &services] { return run_solve(*request, services); }; });
}

} // namespace gradus
