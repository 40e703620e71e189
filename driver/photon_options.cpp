#include "driver/photon_options.h"

#include "driver/number_checks.h"
#include "driver/word_option.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <limits>

namespace gradus {

std::optional<RenderOptions::GatherRadius> gather_radius(const std::string &text) {
    RenderOptions::GatherRadius radius;
    radius.of_scene = text.ends_with('%');
    const std::optional<double> number = finite_number(radius.of_scene ? text.substr(0, text.size() - 1) : text);
    if (!number || !(*number > 0))
        return std::nullopt;
    radius.value = radius.of_scene ? *number / 100 : *number;
    return radius;
}

void add_photon_options(CLI::App &command, RenderOptions &options) {
    const char *group = "Photons (sppm, gpm)";
    command
        .add_option(
            "--photons", options.photons,
            "Light paths a pass, one pass a sample a pixel; 0: as many as leave about five photons a pixel and a "
            "million in all, but no more than four for each of these")
        ->transform(whole_number_between(0, std::numeric_limits<std::int32_t>::max()))
        ->capture_default_str()
        ->group(group);
    command
        .add_option(
            "--gather-roughness", options.gather_roughness,
            "Roughness (alpha) from which on photons are gathered at a surface; from smoother ones camera paths "
            "go on")
        ->check(number_between(0, 1))
        ->capture_default_str()
        ->group(group);
    add_word_option<bool>(
        command, "--direct", {{"sample", false}, {"photons", true}}, options.direct_photons,
        [&options](bool by_photons) { options.direct_photons = by_photons; },
        "How the light that comes directly to a gather point is found: sample, by sampling lights as pt does, or by "
        "photons")
        ->group(group);
    command
        .add_flag("--only-chains", options.only_chains,
                  "For measuring, gpm: no light but by photons that come from a surface too smooth to gather at")
        ->group(group);
    const auto complaint = [](std::string &text) {
        return gather_radius(text) ? std::string()
                                   : fmt::format("'{}' is neither a number above 0 nor a percentage", text);
    };
    command
        .add_option_function<std::string>(
            "--radius", [&options](const std::string &text) { options.radius = *gather_radius(text); },
            "How far photons are gathered from in the first pass: in widths of a pixel as it falls on the surface or, "
            "with %, as a share of the scene's diameter")
        ->type_name("NUMBER|NUMBER%")
        ->check(CLI::Validator(complaint, ""))
        ->default_str("sppm: 2, gpm: 0.5")
        ->group(group);
    command
        .add_option("--radius-alpha", options.radius_alpha,
                    "How slowly the radius shrinks from pass to pass: 1 not at all, near 0 so fast that noise stays")
        ->check(CLI::Validator(
            [](const std::string &text) {
                const std::optional<double> number = finite_number(text);
                return number && *number > 0 && *number <= 1
                           ? std::string()
                           : fmt::format("'{}' is no number above 0 and up to 1", text);
            },
            "(0, 1]"))
        ->capture_default_str()
        ->group(group);
}

} // namespace gradus
