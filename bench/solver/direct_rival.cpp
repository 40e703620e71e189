#include "bench/solver/measurements.h"
#include "bench/solver/rival.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gradus::bench {

namespace {

constexpr double residual_wanted = 1e-4;

struct Contender {
    LinearMethod method;
    PoissonOptions options;
    std::vector<double> seconds, host_seconds, ratios, host_ratios;
    int iterations = 0;
    double residual = 0, error = 0;
};

} // namespace

nlohmann::json measure_direct_rival(const Settings &settings, Problem &problem) {
    Rival rival(problem.width(), problem.height(), channels, settings.threads);
    std::vector<Contender> contenders;
    for (const LinearMethod method : {LinearMethod::cg, LinearMethod::pcg, LinearMethod::multigrid}) {
        PoissonOptions options = l2_steps(method, 0);
        options.tolerance = residual_wanted;
        contenders.push_back({method, options, {}, {}, {}, {}, 0, 0, 0});
        // Warms up, and looks at what the answer is worth, in double precision.
        Contender &c = contenders.back();
        c.iterations = problem.solve(options).report.iterations;
        c.residual = problem.residual(problem.image());
        c.error = problem.error(problem.image());
        problem.solve_on_host(options);
    }
    const PoissonOptions fifty = l2_steps(LinearMethod::cg, 50);
    problem.solve(fifty);

    std::vector<double> rival_seconds, fifty_seconds;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        const double direct = seconds_of([&] { rival.solve(problem.images(), chart_alpha); });
        rival_seconds.push_back(direct);
        for (Contender &c : contenders) {
            c.seconds.push_back(problem.solve(c.options).seconds);
            c.host_seconds.push_back(problem.solve_on_host(c.options).seconds);
            c.ratios.push_back(c.seconds.back() / direct);
            c.host_ratios.push_back(c.host_seconds.back() / direct);
        }
        fifty_seconds.push_back(problem.solve(fifty).seconds);
    }
    const float *direct = rival.solve(problem.images(), chart_alpha);
    const double direct_error = problem.error({direct, direct + channels * problem.pixels()});

    fmt::print("L2 to a relative residual of {:.0e}, {} RGB, alpha {}\n", residual_wanted, problem.name(), chart_alpha);
    fmt::print("  {:<12} {:>6} {:>10} {:>10} {:>12} {:>14}  {}\n", "method", "steps", "residual", "error", "seconds",
               "host arrays", "over FFTW (host arrays)");
    fmt::print("  {:<12} {:>6} {:>10} {:>10.1e} {:>12.4f} {:>14.4f}  1\n", "FFTW DCT", "", "", direct_error,
               median(rival_seconds), median(rival_seconds));
    const Contender *best = nullptr;
    nlohmann::json rows = nlohmann::json::array();
    for (const Contender &c : contenders) {
        fmt::print("  {:<12} {:>6} {:>10.1e} {:>10.1e} {:>12.4f} {:>14.4f}  {:.2f} ({:.2f})\n", method_name(c.method),
                   c.iterations, c.residual, c.error, median(c.seconds), median(c.host_seconds), median(c.ratios),
                   median(c.host_ratios));
        // The solver's own residual is in float: a percent above the tolerance is still on it.
        if (c.residual <= 1.01 * residual_wanted && (!best || median(c.ratios) < median(best->ratios)))
            best = &c;
        rows.push_back({{"method", method_name(c.method)},
                        {"iterations", c.iterations},
                        {"residual", c.residual},
                        {"error", c.error},
                        {"seconds", spread(c.seconds)},
                        {"host_seconds", spread(c.host_seconds)},
                        {"over_fftw", spread(c.ratios)},
                        {"over_fftw_host", spread(c.host_ratios)}});
    }
    if (best)
        fmt::print("  best over FFTW: {} {:.2f} (target at most 1.5)\n", method_name(best->method),
                   median(best->ratios));
    else
        fmt::print("  no method reached the residual\n");
    fmt::print("  50 steps of cg: {:.3f} s (the first code: 0.17 s, on another day)\n", median(fifty_seconds));
    fmt::print("  FFTW: {}, planned in {:.1f} s\n\n", rival.way(), rival.planning_seconds());
    return {{"size", problem.name()},
            {"fftw_seconds", spread(rival_seconds)},
            {"fftw_error", direct_error},
            {"fftw_way", rival.way()},
            {"methods", rows},
            {"best", best ? method_name(best->method) : ""},
            {"cg_50_steps_seconds", spread(fifty_seconds)}};
}

} // namespace gradus::bench
