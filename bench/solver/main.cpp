// gradus-bench-solver: error against time for each method of the Poisson solver, and its distance from its rivals.
#include "bench/program.h"
#include "bench/solver/measurements.h"
#include "bench/write_results.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <set>
#include <thread>

namespace {

const std::vector<std::string> all_parts = {"direct", "weighted", "l1", "bandwidth", "scaling", "curves"};

struct Arguments : gradus::bench::ProgramOptions {
    std::set<std::string> parts{all_parts.begin(), all_parts.end()};
    int repeats = 5;
    double longest = 2;
    bool quick = false;
};

void run(const Arguments &arguments) {
    using namespace gradus;
    using namespace gradus::bench;
    Device device(arguments.device, arguments.threads);
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const Settings settings{device, arguments.threads > 0 ? arguments.threads : cores, arguments.repeats,
                            arguments.longest};
    nlohmann::json results = {{"device", device.description().name},
                              {"platform", device.description().platform},
                              {"threads", settings.threads},
                              {"repeats", arguments.repeats},
                              {"alpha", chart_alpha}};
    const auto wanted = [&](const char *part) { return arguments.parts.contains(part); };
    std::setvbuf(stdout, nullptr, _IOLBF, 0); // each line as it comes, into pipes too
    if (wanted("direct") || wanted("l1") || wanted("bandwidth")) {
        Problem problem(settings, 1280, 720);
        if (wanted("direct"))
            results["direct"] = measure_direct_rival(settings, problem);
        if (wanted("l1"))
            results["l1"] = measure_l1(settings, problem);
        if (wanted("bandwidth"))
            results["bandwidth"].push_back(measure_bandwidth(settings, problem));
    }
    if (wanted("weighted"))
        results["weighted"] = measure_weighted(settings, 1280, 720);
    if (wanted("bandwidth") && !arguments.quick) {
        Problem large(settings, 3840, 2160); // beyond the caches of most processors
        results["bandwidth"].push_back(measure_bandwidth(settings, large));
    }
    if (wanted("scaling"))
        results["scaling"] = measure_scaling(settings, arguments.quick);
    if (wanted("curves"))
        for (const auto &[width, height] : {std::pair(640, 400), {1280, 800}, {3840, 2160}}) {
            if (arguments.quick && width > 2000)
                continue;
            Problem problem(settings, width, height);
            results["curves"].push_back(measure_curves(settings, problem));
        }
    write_results(results, arguments.json);
}

} // namespace

int main(int argc, char **argv) {
    Arguments arguments;
    CLI::App app("Solver benchmarks in one process. Every ratio is of turns of one run, the median of --repeats turns",
                 "gradus-bench-solver");
    app.add_option("--parts", arguments.parts, "Any of direct, weighted, l1, bandwidth, scaling, curves")
        ->check(CLI::IsMember(all_parts))
        ->delimiter(',');
    app.add_option("--repeats", arguments.repeats, "Turns")->check(CLI::Range(1, 1000))->capture_default_str();
    app.add_option("--longest", arguments.longest, "Seconds after which a curve of the charts ends; L1: 5 times these")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    app.add_flag("--quick", arguments.quick, "Leave out the large images");
    gradus::bench::add_program_options(app, arguments);
    return gradus::bench::run_program(app, argc, argv, [&] { run(arguments); });
}
