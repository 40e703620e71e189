#include "driver/commands.h"
#include "driver/number_checks.h"
#include "driver/render_job.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <limits>
#include <memory>

namespace gradus {
namespace {

constexpr const char *notes_of_render = R"(Examples:
  gradus render scene.xml -o out.exr --spp 64 --png
  gradus render scene.xml -o out.exr --time 60 --write-partial 10
  gradus render scene.xml -o out.exr --until-error 0.01 --reconstruction guided
  gradus render scene.xml -o out.exr --size 1280x720 --crop 600,300,128,128 --aov
  gradus render scene.xml -o out.exr -D spp=16 -D light=2.5 --stats out.json

Ctrl-C, SIGTERM: the image of the samples so far is written, exit code 130. A second one ends at once.
The image depends on --seed and on what is rendered, never on --nthreads or --batch-size.)";

} // namespace

void add_render_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("render", "Render a scene to an EXR image");
    const auto request = std::make_shared<RenderRequest>();
    command.footer(notes_of_render);
    add_scene_options(command, request->scene);

    const char *output = "Output";
    command.add_option("-o,--output", request->outputs.image, "Image to write: 32-bit float EXR, replaced in one step")
        ->required()
        ->type_name("FILE.exr")
        ->group(output);
    command
        .add_flag(
            "--layers", request->method.options.layers,
            "Also write what the image was reconstructed from, for `gradus solve`: primal, dx, dy, direct; with "
            "--aov also their variances; of weighted and guided both halves and, of guided, albedo, normal, depth")
        ->group(output);
    command.add_flag("--png", request->outputs.png, "Also write a PNG beside it: sRGB curve, exposure 1, clamped")
        ->group(output);
    command.add_option("--stats", request->outputs.statistics, "Write statistics as JSON; - is stdout")
        ->type_name("FILE")
        ->group(output);
    command.add_option("--write-partial", request->partial_interval, "Write the image so far every so many seconds")
        ->type_name("SECONDS")
        ->check(positive_number())
        ->group(output);
    command.add_flag("-q,--quiet", request->quiet, "Print errors only")->group(output);

    const char *samples = "Samples";
    command
        .add_option("--time", request->time_limit,
                    "Render for so many seconds, kernels compiled; the file's sample count is then no limit, --spp is")
        ->type_name("SECONDS")
        ->check(positive_number())
        ->group(samples);
    command
        .add_option_function<std::string>(
            "--until-error",
            [request](const std::string &value) {
                request->until_error = *finite_number(value);
                request->method.options.error = true;
            },
            "Render until relMSE, the mean over pixels and channels of (error)^2 / (value^2 + 0.001), is estimated at "
            "this or less (pt, gpt): 0.01 is noise of a tenth. Looked at after 16, 32, 64 ... samples a pixel; the "
            "file's sample count is then no limit, --spp and --time are. Implies --error")
        ->type_name("RELMSE")
        ->check(positive_number())
        ->group(samples);
    command.add_option("--seed", request->method.options.seed, "Images of different seeds are independent")
        ->transform(whole_number_between(0, std::numeric_limits<std::uint64_t>::max()))
        ->capture_default_str()
        ->group(samples);

    add_method_options(command, services, request->method);
    command.callback([request, &command, &services, &chosen] {
        request->method.given = given_options(command);
        chosen = [request, &services] { return run_render(*request, services); };
    });
}

} // namespace gradus
