#include "driver/method_request.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <optional>

namespace gradus {

void add_method_options(CLI::App &command, const Services &services, MethodRequest &request) {
    const char *group = "Method and machine";
    command
        .add_option("--method", request.method, "Rendering method: pt, path tracing; gpt, gradient-domain path tracing")
        ->check(CLI::IsMember(services.method_names()))
        ->capture_default_str()
        ->group(group);
    command.add_option("--device", request.device, "OpenCL device: a number of `gradus devices` or a part of its name")
        ->group(group);
    command.add_option("--nthreads", request.options.threads, "Processor threads; 0: all")
        ->check(CLI::Range(0, 4096))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--batch-size", request.options.batch_size,
                    "Paths in flight at once; 0: the device's default. The image does not depend on it")
        ->check(CLI::Range(std::uint32_t(0), std::uint32_t(1) << 28))
        ->capture_default_str()
        ->group(group);
    command.add_flag("--aov", request.options.aov, "Also write albedo, normal, depth and variance layers")
        ->group(group);
    const char *reconstruction = "Reconstruction (gpt)";
    command
        .add_option_function<std::string>(
            "--norm", [&request](const std::string &name) { request.options.reconstruction_l2 = name.back() == '2'; },
            "L1: robust; L2: linear")
        ->check(CLI::IsMember({"L1", "L2"}, CLI::ignore_case))
        ->default_str("L1")
        ->group(reconstruction);
    command
        .add_option_function<std::string>(
            "--alpha",
            [&request](const std::string &text) {
                request.options.alpha = text == "auto" ? std::nullopt : std::optional(std::stod(text));
            },
            "Weight of the primal image against its differences; auto: from their variances")
        ->type_name("NUMBER|auto")
        ->check(CLI::Validator(
            [](std::string &text) {
                double number = 0;
                const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
                const bool is_number = failure == std::errc{} && stop == text.data() + text.size();
                return text == "auto" || (is_number && std::isfinite(number) && number >= 0)
                           ? std::string()
                           : fmt::format("'{}' is neither a number from 0 on nor auto", text);
            },
            ""))
        ->default_str("auto")
        ->group(reconstruction);
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

} // namespace gradus
