#include "driver/reconstruction_options.h"

#include "driver/number_checks.h"
#include "driver/word_option.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <vector>

namespace gradus {

void add_reconstruction_option(CLI::App &command, const char *group, Reconstruction standard,
                               std::function<void(Reconstruction)> set) {
    Words<Reconstruction> words;
    for (const auto reconstruction :
         {Reconstruction::l1, Reconstruction::l2, Reconstruction::weighted, Reconstruction::guided})
        words.emplace_back(reconstruction_name(reconstruction), reconstruction);
    CLI::Option *reconstruction =
        add_word_option<Reconstruction>(
            command, "--reconstruction", words, standard, set,
            "l1: robust; l2: linear, one weight for all pixels; weighted: linear, each pixel and each difference "
            "weighted by its variance, and without bias: two halves of the samples judge each other; guided: the "
            "same, and a filtered image where that has less error, by place: consistent, the least error")
            ->group(group);
    add_word_option<Reconstruction>(command, "--norm", {{"L1", Reconstruction::l1}, {"L2", Reconstruction::l2}},
                                    standard, set, "The old name of --reconstruction l1 and l2", CLI::ignore_case)
        ->excludes(reconstruction)
        ->group(group);
}

void add_guide_option(CLI::App &command, const char *group, std::function<void(Guide)> set) {
    add_word_option<Guide>(
        command, "--guide", {{"filter", Guide::filter}, {"denoiser", Guide::denoiser}}, Guide::filter, std::move(set),
        "Of --reconstruction guided: filter, by albedo, normal, depth and noise; or denoiser, Open Image Denoise where "
        "it is installed (GRADUS_DENOISER may name its library)")
        ->group(group);
}

void check_alpha(Reconstruction reconstruction, bool given, double alpha) {
    if (given && needs_halves(reconstruction))
        throw Error(
            ExitCode::usage,
            fmt::format("--alpha is one weight of the primal; --reconstruction {} gives each pixel its own: add "
                        "--reconstruction l1 or l2",
                        reconstruction_name(reconstruction)));
    if (given && reconstruction == Reconstruction::l1 && alpha > 0 && alpha < least_alpha_of_absolute_values)
        throw Error(ExitCode::usage,
                    fmt::format("--alpha {} is lost in rounding beside the differences: --reconstruction l1 takes 0, "
                                "or {} and more",
                                alpha, least_alpha_of_absolute_values));
}

void add_alpha_option(CLI::App &command, const char *group, const char *standard, const char *text,
                      std::function<void(std::optional<double>)> set) {
    const auto complaint = [](std::string &value) {
        const auto number = finite_number(value);
        return value == "auto" || (number && *number >= 0 && *number <= largest_alpha)
                   ? std::string()
                   : fmt::format("'{}' is neither a number from 0 to {:g} nor auto", value, largest_alpha);
    };
    command
        .add_option_function<std::string>(
            "--alpha", [set = std::move(set)](const std::string &value) { set(finite_number(value)); }, text)
        ->type_name("NUMBER|auto")
        ->check(CLI::Validator(complaint, ""))
        ->default_str(standard)
        ->group(group);
}

} // namespace gradus
