// gradus-bench-kernels: how fast each kernel is in its builds, how exact kernels/lib is on the device, what tuning
// gains, how fast rows are sorted, photons gathered and chains walked.
#include "bench/kernels/measurements.h"
#include "bench/program.h"
#include "bench/write_results.h"
#include "methods/method.h"
#include "planning/make_method.h"
#include "runtime/device/pocl_compiler.h"
#include "runtime/device/program.h"
#include "runtime/scene/traits.h"

#include <CLI/CLI.hpp>
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <set>

namespace {

const std::vector<std::string> all_parts = {"throughput", "accuracy", "tuning", "sort", "photons"};

struct Arguments : gradus::bench::ProgramOptions {
    std::set<std::string> parts{all_parts.begin(), all_parts.end()};
    std::string scene = GRADUS_SCENES "/cornell-box.xml";
    std::vector<int> queue_bits = {10, 14, 18};
    std::vector<std::string> kinds = gradus::all_bsdf_kinds(), methods = {"pt", "gpt", "sppm", "gpm"};
    int repeats = 5;
    std::uint32_t cases = 200'000;
    bool quick = false, no_vectoriser = false;
};

void run(const Arguments &arguments) {
    using namespace gradus;
    using namespace gradus::bench;
    Device device(arguments.device, arguments.threads);
    const std::shared_ptr<void> compilers = keep_compilers(device); // kernels are built one by one
    const bool quick = arguments.quick;
    Settings settings{device,
                      arguments.threads,
                      arguments.scene,
                      arguments.repeats,
                      {},
                      arguments.kinds,
                      arguments.methods,
                      arguments.cases,
                      quick,
                      !arguments.no_vectoriser && !quick};
    for (const int bits : arguments.queue_bits)
        if (!quick || bits <= 14)
            settings.queue_sizes.push_back(std::uint32_t(1) << bits);
    if (quick) {
        settings.kinds = {"diffuse", "roughdielectric_ggx"};
        settings.cases = std::min(settings.cases, 20'000u);
    }
    if (arguments.parts.contains("remarks")) {
        prepare_pocl_compiler(settings.device); // as the processes that compile have it
        remark_on_kernels(settings);
        return;
    }
    nlohmann::json results = {{"device", device.description().name},
                              {"platform", device.description().platform},
                              {"driver", device.description().driver},
                              {"repeats", arguments.repeats}};
    std::setvbuf(stdout, nullptr, _IOLBF, 0); // each line as it comes, into pipes too
    fmt::print("{} ({})\n", device.description().name, device.description().platform);
    if (!device.description().has_double)
        fmt::print("no double precision on this device: no double builds, no accuracy\n");
    if (arguments.parts.contains("throughput"))
        results["throughput"] = measure_throughput(settings);
    if (arguments.parts.contains("accuracy") && device.description().has_double)
        results["accuracy"] = measure_accuracy(settings);
    if (arguments.parts.contains("tuning"))
        results["tuning"] = measure_tuning(settings);
    if (arguments.parts.contains("sort"))
        results["sort"] = measure_sort(settings);
    if (arguments.parts.contains("photons"))
        results["photons"] = measure_photons(settings);
    write_results(results, arguments.json);
}

} // namespace

int main(int argc, char **argv) {
    // Google Benchmark takes its options from here alone.
    std::string interleave = "--benchmark_enable_random_interleaving=true";
    char *benchmark_arguments[] = {argv[0], interleave.data(), nullptr};
    int benchmark_count = 2;
    benchmark::Initialize(&benchmark_count, benchmark_arguments);

    Arguments arguments;
    CLI::App app("Kernel benchmarks. Every ratio is of runs that are mixed in one process, the median of --repeats",
                 "gradus-bench-kernels");
    app.add_option(
           "--parts", arguments.parts,
           "Any of throughput, accuracy, tuning, sort, photons; or remarks, what PoCL's compiler says of each kernel")
        ->check(CLI::IsMember({"throughput", "accuracy", "tuning", "sort", "photons", "remarks"}))
        ->delimiter(',');
    app.add_option("--scene", arguments.scene, "The room whose surfaces take each kind")->capture_default_str();
    app.add_option("--kinds", arguments.kinds, "BSDF kinds")
        ->check(CLI::IsMember(gradus::all_bsdf_kinds()))
        ->delimiter(',');
    app.add_option("--methods", arguments.methods,
                   "Rendering methods whose kernels are measured; those of photons with kinds that gather some")
        ->check(CLI::IsMember(gradus::method_names()))
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--queue-bits", arguments.queue_bits, "Base-2 logarithms of the queues' sizes, even numbers")
        ->check(CLI::IsMember({6, 8, 10, 12, 14, 16, 18, 20, 22}))
        ->delimiter(',')
        ->capture_default_str();
    app.add_option("--cases", arguments.cases, "Arguments for each function and domain, of the accuracy")
        ->check(CLI::Range(1000, 100'000'000))
        ->capture_default_str();
    app.add_option("--repeats", arguments.repeats, "Runs of each build")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_flag("--quick", arguments.quick, "Two kinds, no queue over 2^14, fewer cases, nothing on the vectoriser");
    app.add_flag("--no-vectoriser", arguments.no_vectoriser,
                 "Do not ask PoCL what it vectorised, which compiles each kernel anew");
    gradus::bench::add_program_options(app, arguments);
    return gradus::bench::run_program(app, argc, argv, [&] { run(arguments); });
}
