#include "driver/method_request.h"
#include "planning/make_method.h"

#include "driver/device_options.h"
#include "driver/number_checks.h"
#include "driver/photon_options.h"
#include "driver/reconstruction_options.h"
#include "driver/word_option.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

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
    add_device_options(command, group, request.device, request.options.threads);
    command
        .add_option("--batch-size", request.options.batch_size,
                    "Paths in flight at once; 0: what `gradus tune` found, or the device's default. The image does "
                    "not depend on it")
        ->transform(whole_number_between(0, std::uint32_t(1) << 28))
        ->capture_default_str()
        ->group(group);
    const auto add_words = [&command]<class Value>(const char *name, Value &value, const Words<Value> &words,
                                                   const char *text) {
        return add_word_option<Value>(
            command, name, words, value, [&value](Value given) { value = given; }, text);
    };
    add_words("--precision", request.options.precision,
              {{"single", Precision::single}, {"double", Precision::double_}, {"relaxed", Precision::relaxed}},
              "Arithmetic of the kernels: single, double, or relaxed: single, and the compiler may reorder and "
              "approximate")
        ->group(group);
    using Sampler = RenderOptions::Sampler;
    add_words("--sampler", request.options.sampler, {{"sobol", Sampler::sobol}, {"independent", Sampler::independent}},
              "How the samples of a pixel are drawn: sobol, evenly, from a sequence scrambled by pixel and dimension, "
              "with less noise; independent, each by itself, whose variances are exact")
        ->group(group);
    using Lights = RenderOptions::Lights;
    add_words("--lights", request.options.lights,
              {{"auto", Lights::automatic}, {"tree", Lights::tree}, {"power", Lights::power}},
              "How light samples choose a light: power, by what it sends; tree, by what may arrive; auto: tree where "
              "there are many lights")
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
    using Strategy = RenderOptions::Strategy;
    add_words("--strategy", request.options.strategy,
              {{"mis", Strategy::mis}, {"light", Strategy::light}, {"bsdf", Strategy::bsdf}},
              "How light is found: mis (both, weighted), light or bsdf sampling alone")
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
