#include "bench/kernels/interleaved.h"

#include <benchmark/benchmark.h>

#include <algorithm>

namespace gradus::bench {

namespace {

/// Keeps the seconds of each run; what is printed is the caller's.
class Keeper final : public benchmark::BenchmarkReporter {
  public:
    bool ReportContext(const Context &) override { return true; }
    void ReportRuns(const std::vector<Run> &runs) override {
        for (const Run &run : runs)
            if (run.run_type == Run::RT_Iteration)
                seconds[run.run_name.function_name].push_back(run.real_accumulated_time / double(run.iterations));
    }
    std::map<std::string, std::vector<double>> seconds;
};

} // namespace

std::map<std::string, std::vector<double>>
run_interleaved(const std::map<std::string, std::function<double()>> &functions, int repeats) {
    for (const auto &[name, function] : functions)
        benchmark::RegisterBenchmark(name.c_str(),
                                     [&function = function](benchmark::State &state) {
                                         for (auto _ : state)
                                             state.SetIterationTime(function());
                                     })
            ->UseManualTime()
            ->Iterations(1)
            ->Repetitions(repeats);
    Keeper keeper;
    benchmark::RunSpecifiedBenchmarks(&keeper);
    benchmark::ClearRegisteredBenchmarks();
    return keeper.seconds;
}

Triad::Triad(Device &device, double bytes)
    : device_(device), count_(std::max<std::uint32_t>(1, static_cast<std::uint32_t>(bytes / 12 + 1))) {
    const std::vector<float> ones(count_, 1.0f);
    a_ = Buffer(device, "a", ones.data(), ones.size() * sizeof(float));
    b_ = Buffer(device, "b", ones.data(), ones.size() * sizeof(float));
    c_ = Buffer(device, "c", ones.data(), ones.size() * sizeof(float));
    kernel_ = KernelLibrary(device, {}).build({{"triad", "kernels/measure/triad.cl", "triad", {}}}).front();
    for (const Buffer *buffer : {&a_, &b_, &c_})
        kernel_.bind(*buffer);
    kernel_.set("count", count_);
}

double Triad::seconds() {
    kernel_.reset_usage();
    kernel_.launch(count_);
    finish(device_);
    return kernel_.usage().seconds;
}

double Triad::bytes() const { return 12.0 * count_; }

} // namespace gradus::bench
