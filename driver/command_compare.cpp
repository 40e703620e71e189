#include "driver/commands.h"
#include "driver/comparison.h"
#include "driver/limits_option.h"
#include "driver/number_checks.h"
#include "driver/output_files.h"
#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/io/atomic_file.h"
#include "runtime/io/image_io.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <memory>

namespace gradus {
namespace {

constexpr const char *notes_of_compare = R"(Examples:
  gradus compare out.exr reference.exr --error-image error.png
  gradus compare seed-*.exr mean.exr --variance variance.exr --reference-spp 32768 --check

relMSE      mean over pixels and channels of (I - R)^2 / (R^2 + 0.001)
trimmed     the same without the worst 0.1 % of the pixels
PSNR        of linear values; the peak is the reference's 99.9th percentile
mean ratio  mean of the image over mean of the reference
z           (mean of ours - reference) / standard error, as quantiles of the normal distribution

With --check the exit code is 1 unless: over the whole image and in blocks |z| stays under what chance exceeds
once in a thousand comparisons (or under --threshold), no more blocks are over 3 than chance has it, all values
are finite, and no two images have the same seed.)";

struct Arguments {
    CompareRequest request;
    std::vector<std::string> files;
    std::string error_image, json;
    bool check = false;
};

void write_error_image(const Comparison &comparison, const std::string &path) {
    const Image error = relative_error_image(comparison.mean_image, comparison.reference_image);
    const std::string extension = std::filesystem::path(path).extension().string();
    if (extension == ".exr")
        write_image(error, path);
    else
        write_png(error_picture(error), path);
}

/// Before anything is read: a comparison of large images takes a while.
void check_files(const Arguments &arguments) {
    std::vector<std::string> inputs = arguments.request.images;
    inputs.push_back(arguments.request.reference);
    inputs.push_back(arguments.request.variance);
    const std::string extension = std::filesystem::path(arguments.error_image).extension().string();
    if (!arguments.error_image.empty() && extension != ".exr" && extension != ".png")
        throw Error(ExitCode::usage,
                    fmt::format("the error image '{}' must end in .png or .exr", arguments.error_image));
    const std::vector<NamedFile> outputs{{"--error-image", arguments.error_image}, {"--json", arguments.json}};
    for (const NamedFile &output : outputs)
        if (!output.path.empty() && output.path != "-")
            check_writable(output.path);
    check_distinct(outputs, inputs);
}

int run_compare(Arguments arguments) {
    arguments.request.reference = arguments.files.back();
    arguments.files.pop_back();
    arguments.request.images = arguments.files;
    check_files(arguments);
    const Comparison comparison = compare_images(arguments.request);
    if (!arguments.error_image.empty())
        write_error_image(comparison, arguments.error_image);
    if (!arguments.json.empty())
        write_json(comparison_json(comparison), arguments.json);
    if (arguments.json != "-")
        print_result(comparison_text(comparison));
    if (arguments.check && !comparison.judged && comparison.failures.empty())
        throw Error(ExitCode::failure,
                    fmt::format("--check has nothing to judge by: give {}, or --max-relmse", what_bias_needs));
    const bool failed = arguments.check && !comparison.failures.empty();
    return static_cast<int>(failed ? ExitCode::failure : ExitCode::success);
}

} // namespace

void add_compare_command(CLI::App &app, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("compare", "Compare images of independent seeds with a reference");
    const auto arguments = std::make_shared<Arguments>();
    CompareRequest &request = arguments->request;
    command.footer(notes_of_compare);
    command.add_option("IMAGES", arguments->files, "One image or several of independent seeds, then the reference")
        ->required()
        ->expected(2, 1 << 20)
        ->option_text("IMAGE... REFERENCE REQUIRED");
    command.add_option("--layer", request.layer, "Compare this layer (albedo, normal, ...) instead of R, G, B");
    command.add_option("--error-image", arguments->error_image,
                       "Write signed relative errors: .png red too bright, blue too dark, white equal; .exr values");
    command.add_option("--json", arguments->json, "Write all figures as JSON; - is stdout, in place of the text")
        ->type_name("FILE");
    const char *group = "z test";
    command
        .add_option("--variance", request.variance,
                    "Variance of the reference's mean, by pixel: an image, or one of ours with the layer")
        ->type_name("IMAGE")
        ->group(group);
    command.add_option("--spp", request.samples_per_pixel, "Samples a pixel of each image; else as its metadata says")
        ->check(positive_number())
        ->group(group);
    command
        .add_option("--reference-spp", request.reference_spp,
                    "Samples a pixel of the reference; else as its metadata says. With --variance it gives a floor to "
                    "the variance of our images")
        ->check(positive_number())
        ->group(group);
    command
        .add_option("--reference-batches", request.reference_batches,
                    "Independent batches that the reference's variance was estimated from")
        ->transform(whole_number_between(2, 1 << 30))
        ->capture_default_str()
        ->group(group);
    command.add_option("--block", request.block, "Side of the blocks in pixels")
        ->transform(whole_number_between(1, 65536))
        ->capture_default_str()
        ->group(group);
    command.add_option("--threshold", request.threshold, "Largest |z| of a block that passes")
        ->check(positive_number())
        ->group(group);
    command.add_option("--max-relmse", request.largest_relative_mse, "Largest relMSE of the images' mean that passes")
        ->check(positive_number())
        ->group(group);
    command.add_flag("--check", arguments->check, "Exit with 1 unless the comparison holds")->group(group);
    add_limits_option(command, request.limits, "Images");
    command.callback([arguments, &chosen] { chosen = [arguments] { return run_compare(*arguments); }; });
}

} // namespace gradus
