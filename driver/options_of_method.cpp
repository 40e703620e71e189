#include "driver/options_of_method.h"

#include "driver/method_request.h"
#include "driver/reconstruction_options.h"
#include "runtime/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace gradus {
namespace {

using Methods = std::vector<std::string>;

/// Options of some methods alone. What an image must hold is asked for whatever method `auto` chooses; the others say
/// how the methods work that it may choose.
struct OptionOfMethods {
    const char *option;
    Methods methods;
    bool is_of_image = false;
};

const std::vector<OptionOfMethods> options_of_methods{
    {"--layers", {"gpt", "gpm"}, true}, {"--reconstruction", {"gpt", "gpm"}},    {"--norm", {"gpt", "gpm"}},
    {"--guide", {"gpt", "gpm"}},        {"--shift-threshold", {"gpt"}},          {"--shift-distance", {"gpt"}},
    {"--photons", {"sppm", "gpm"}},     {"--gather-roughness", {"sppm", "gpm"}}, {"--direct", {"sppm", "gpm"}},
    {"--radius", {"sppm", "gpm"}},      {"--radius-alpha", {"sppm", "gpm"}}};

bool is_among(const std::string &method, const Methods &methods) {
    return std::find(methods.begin(), methods.end(), method) != methods.end();
}

bool has_differences(const std::string &method) { return method != "pt" && method != "sppm"; }

} // namespace

void check_method_options(const MethodRequest &request) {
    const RenderOptions &options = request.options;
    if (has_differences(request.method))
        check_alpha(options.reconstruction, options.alpha.has_value(), options.alpha.value_or(0));
    else if (options.alpha)
        throw Error(ExitCode::usage,
                    fmt::format("--alpha weighs an image against its differences, and {} has none", request.method));
    if (request.given.count("--guide") && options.reconstruction != Reconstruction::guided)
        throw Error(ExitCode::usage, "--guide is of one reconstruction: add --reconstruction guided");
}

std::vector<std::string> unread_options(const MethodRequest &request, const std::string &method) {
    // Guided path tracing reconstructs, too.
    const bool reconstructs_as_pt = method == "pt" && request.options.reconstruction == Reconstruction::guided;
    std::vector<std::string> sentences;
    for (const auto &[option, methods, is_of_image] : options_of_methods) {
        const bool may_be_read = request.method == "auto" && (method == "auto" || !is_of_image);
        const bool is_of_reconstruction = is_among("gpt", methods) && is_among("gpm", methods);
        if (!request.given.count(option) || may_be_read || is_among(method, methods) ||
            (is_of_reconstruction && reconstructs_as_pt))
            continue;
        const std::string exception =
            method == "pt" && is_of_reconstruction ? "; of pt with --reconstruction guided alone" : "";
        sentences.push_back(fmt::format("{} changes nothing with {}: it is for {}{}", option, method,
                                        fmt::join(methods, " and "), exception));
    }
    return sentences;
}

} // namespace gradus
