// gradus-bench-render: how near a render comes to its floor, and what specialised kernels and ordered rays gain.
#include "bench/program.h"
#include "bench/render/measurements.h"
#include "bench/write_results.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <set>
#include <string_view>

namespace {

struct Arguments : gradus::bench::ProgramOptions {
    std::vector<std::string> scenes;
    std::set<std::string> parts = {"floor", "specialisation", "order"};
    std::string method = "pt";
    std::uint64_t samples_per_pixel = 64;
    int repeats = 5;
    bool no_roulette_only = false;
};

constexpr const char *all_parts[] = {"floor", "specialisation", "order", "light-paths", "chains", "loading"};

struct SceneSize {
    std::string path;
    std::uint32_t width = 0, height = 0;
};

/// 0 where the text is not a number alone.
std::uint32_t parse_size(std::string_view text) {
    std::uint32_t size = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), size);
    return error == std::errc() && end == text.data() + text.size() ? size : 0;
}

SceneSize parse_scene(const std::string &text) {
    const std::size_t colon = text.rfind(':'), times = text.find('x', colon == std::string::npos ? 0 : colon);
    SceneSize s;
    if (colon != std::string::npos && times != std::string::npos) {
        const std::string_view size = text;
        s = {text.substr(0, colon), parse_size(size.substr(colon + 1, times - colon - 1)),
             parse_size(size.substr(times + 1))};
    }
    if (s.width == 0 || s.height == 0)
        throw gradus::Error(gradus::ExitCode::usage, fmt::format("'{}' is not SCENE.xml:WxH", text));
    return s;
}

void run(const Arguments &arguments) {
    using namespace gradus;
    using namespace gradus::bench;
    std::vector<SceneSize> scenes;
    for (const std::string &text : arguments.scenes)
        scenes.push_back(parse_scene(text));
    Device device(arguments.device, arguments.threads);
    const Settings settings{device, arguments.threads, arguments.repeats, arguments.method};
    nlohmann::json results = {{"device", device.description().name},
                              {"platform", device.description().platform},
                              {"threads", arguments.threads},
                              {"repeats", arguments.repeats}};
    for (const char *part : all_parts)
        if (arguments.parts.contains(part))
            results[part] = nlohmann::json::array();
    for (const SceneSize &s : scenes) {
        if (arguments.parts.contains("loading"))
            results["loading"].push_back(measure_loading(settings, s.path));
        if (arguments.parts == std::set<std::string>{"loading"})
            continue;
        const Job compared = load_job(s.path, s.width, s.height, arguments.samples_per_pixel, false);
        render(settings, load_job(s.path, s.width, s.height, 1, false)); // wakes the machine, fills the kernel cache
        if (arguments.parts.contains("floor")) {
            if (!arguments.no_roulette_only)
                results["floor"].push_back(
                    measure_floor(settings, load_job(s.path, s.width, s.height, arguments.samples_per_pixel, true)));
            results["floor"].push_back(measure_floor(settings, compared));
        }
        if (arguments.parts.contains("specialisation"))
            results["specialisation"].push_back(measure_specialisation(settings, compared));
        if (arguments.parts.contains("light-paths"))
            for (const bool roulette : {false, true})
                results["light-paths"].push_back(measure_light_paths(
                    settings, load_job(s.path, s.width, s.height, arguments.samples_per_pixel, roulette)));
        if (arguments.parts.contains("chains"))
            results["chains"].push_back(
                measure_chains(settings, load_job(s.path, s.width, s.height, arguments.samples_per_pixel, true)));
        if (arguments.parts.contains("order"))
            results["order"].push_back(measure_ray_order(settings, compared));
        std::fflush(stdout);
    }
    write_results(results, arguments.json);
}

} // namespace

int main(int argc, char **argv) {
    Arguments arguments;
    CLI::App app("Render benchmarks in one process. Every figure is a ratio, the median of --repeats turns",
                 "gradus-bench-render");
    app.add_option("SCENES", arguments.scenes, "SCENE.xml:WxH")->required();
    app.add_option("--parts", arguments.parts, "Any of floor, specialisation, order, light-paths, chains, loading")
        ->check(CLI::IsMember(std::set<std::string>(std::begin(all_parts), std::end(all_parts))))
        ->delimiter(',');
    app.add_option("--spp", arguments.samples_per_pixel, "Samples a pixel")
        ->check(CLI::Range(1, 1 << 30))
        ->capture_default_str();
    app.add_option("--repeats", arguments.repeats, "Turns")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--method", arguments.method, "pt or gpt")
        ->check(CLI::IsMember({"pt", "gpt"}))
        ->capture_default_str();
    app.add_flag("--no-roulette-only", arguments.no_roulette_only, "Leave out the floor with the file's own settings");
    gradus::bench::add_program_options(app, arguments);
    return gradus::bench::run_program(app, argc, argv, [&] { run(arguments); });
}
