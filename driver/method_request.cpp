#include "driver/method_request.h"
#include "planning/make_method.h"

#include "driver/number_checks.h"
#include "driver/photon_options.h"
#include "driver/reconstruction_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <map>
#include <optional>

namespace gradus {

void add_method_options(CLI::App &command, const Services &services, MethodRequest &request) {
    const char *group = "Method and machine";
    command
        .add_option(
            "--method", request.method,
            "Rendering method: pt, path tracing; gpt, gradient-domain path tracing; sppm, stochastic progressive "
            "photon mapping; gpm, gradient-domain photon mapping; auto, whichever of pt, gpt and gpm a short pilot "
            "render finds better")
        ->check(CLI::IsMember(services.method_names()))
        ->capture_default_str()
        ->group(group);
    command.add_option("--device", request.device, "OpenCL device: a number of `gradus devices` or a part of its name")
        ->group(group);
    command.add_option("--nthreads", request.options.threads, "Processor threads; 0: all")
        ->transform(whole_number_between(0, 4096))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--batch-size", request.options.batch_size,
                    "Paths in flight at once; 0: what `gradus tune` found, or the device's default. The image does "
                    "not depend on it")
        ->transform(whole_number_between(0, std::uint32_t(1) << 28))
        ->capture_default_str()
        ->group(group);
    const std::map<std::string, Precision> precisions{
        {"single", Precision::single}, {"double", Precision::double_}, {"relaxed", Precision::relaxed}};
    command
        .add_option_function<std::string>(
            "--precision",
            [&request, precisions](const std::string &name) { request.options.precision = precisions.at(name); },
            "Arithmetic of the kernels: single, double, or relaxed: single, and the compiler may reorder and "
            "approximate")
        ->check(CLI::IsMember({"single", "double", "relaxed"}))
        ->default_str("single")
        ->group(group);
    const std::map<std::string, RenderOptions::Sampler> samplers{{"sobol", RenderOptions::Sampler::sobol},
                                                                 {"independent", RenderOptions::Sampler::independent}};
    command
        .add_option_function<std::string>(
            "--sampler", [&request, samplers](const std::string &name) { request.options.sampler = samplers.at(name); },
            "How the samples of a pixel are drawn: sobol, evenly, from a sequence scrambled by pixel and dimension, "
            "with less noise; independent, each by itself, whose variances are exact")
        ->check(CLI::IsMember({"sobol", "independent"}))
        ->default_str("sobol")
        ->group(group);
    const std::map<std::string, RenderOptions::Lights> lights{{"auto", RenderOptions::Lights::automatic},
                                                              {"tree", RenderOptions::Lights::tree},
                                                              {"power", RenderOptions::Lights::power}};
    command
        .add_option_function<std::string>(
            "--lights", [&request, lights](const std::string &name) { request.options.lights = lights.at(name); },
            "How light samples choose a light: power, by what it sends; tree, by what may arrive; auto: tree where "
            "there are many lights")
        ->check(CLI::IsMember({"auto", "tree", "power"}))
        ->default_str("auto")
        ->group(group);
    CLI::Option *aov =
        command.add_flag("--aov", request.options.aov, "Also write albedo, normal, depth and variance layers")
            ->group(group);
    command
        .add_flag("!--no-variance", request.options.variance,
                  "With --aov: no layers of variances. For these the samples of a pixel are four sequences in place of "
                  "one, unless they are independent, and the image has a little more noise")
        ->needs(aov)
        ->group(group);
    command
        .add_flag("--error", request.options.error,
                  "Also the layer error: the estimated root mean square error by pixel and channel (pt, gpt), from two "
                  "halves of the samples, which have random numbers of their own for it. weighted and guided have such "
                  "halves, and the layer with --aov")
        ->group(group);
    const char *reconstruction = "Reconstruction (gpt, gpm, auto; guided of pt, too)";
    add_reconstruction_option(command, reconstruction, request.options.reconstruction,
                              [&request](Reconstruction name) { request.options.reconstruction = name; });
    add_guide_option(command, reconstruction, [&request](Guide guide) { request.options.guide = guide; });
    add_alpha_option(command, reconstruction, "auto",
                     "Weight of the primal image against its differences; auto: from their variances",
                     [&request](std::optional<double> alpha) { request.options.alpha = alpha; });
    const auto add_shift_option = [&command](const char *name, double &value, const char *text) {
        command.add_option(name, value, text)
            ->check(number_between(0, 1))
            ->capture_default_str()
            ->group("Shifts (gpt)");
    };
    add_shift_option("--shift-threshold", request.options.shift_threshold,
                     "Roughness (alpha) from which on offset paths reconnect at a surface; on smoother ones they copy "
                     "the half vector");
    add_shift_option("--shift-distance", request.options.shift_distance,
                     "Offset paths copy instead of reconnecting over ways shorter than this share of the scene's "
                     "diameter, or than eight times the distance of the two paths if that is less; 0: never");
    add_photon_options(command, request.options);
    const char *measuring = "For measuring";
    command
        .add_option("--dump-kernels", request.options.dump_kernels, "Write the source of each kernel to this folder")
        ->type_name("DIR")
        ->group(measuring);
    command
        .add_flag("--all-traits", request.options.all_traits,
                  "Compile the kernels for everything, as if the scene had it")
        ->group(measuring);
    const std::map<std::string, RenderOptions::Strategy> strategies{{"mis", RenderOptions::Strategy::mis},
                                                                    {"light", RenderOptions::Strategy::light},
                                                                    {"bsdf", RenderOptions::Strategy::bsdf}};
    command
        .add_option_function<std::string>(
            "--strategy",
            [&request, strategies](const std::string &name) { request.options.strategy = strategies.at(name); },
            "How light is found: mis (both, weighted), light or bsdf sampling alone")
        ->check(CLI::IsMember({"mis", "light", "bsdf"}))
        ->default_str("mis")
        ->group(measuring);
}

std::set<std::string> given_options(const CLI::App &command) {
    std::set<std::string> given;
    for (const CLI::Option *option : command.get_options())
        if (option->count() > 0)
            for (const std::string &name : option->get_lnames())
                given.insert("--" + name);
    return given;
}

} // namespace gradus
