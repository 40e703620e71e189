#include "bench/solver/measurements.h"

#include <fmt/format.h>

namespace gradus::bench {

namespace {

constexpr double first_code_seconds = 3.3; // 20 x 50 at 1280x720, OpenMP in double precision, as measured once

} // namespace

nlohmann::json measure_l1(const Settings &settings, Problem &problem) {
    PoissonOptions ours, plain;
    plain.method = LinearMethod::cg;
    plain.inner_iterations = 50;
    plain.iterations = 20;
    plain.tolerance = 1e-12;
    plain.keep_mean = false; // the first code has none, and it takes time
    const PoissonReport our_report = problem.solve(ours).report, plain_report = problem.solve(plain).report;
    std::vector<double> seconds, plain_seconds, ratios;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        seconds.push_back(problem.solve(ours).seconds);
        plain_seconds.push_back(problem.solve(plain).seconds);
        ratios.push_back(plain_seconds.back() / seconds.back());
    }
    const double objectives = our_report.objective / plain_report.objective;
    const double over_first = first_code_seconds / median(seconds);
    fmt::print("L1, {} RGB, alpha {}\n", problem.name(), ours.alpha);
    fmt::print("  {:<22} {:>13} {:>7} {:>10} {:>14}\n", "", "reweightings", "steps", "seconds", "objective");
    for (const auto &[name, report, times] :
         {std::tuple("default, " + our_report.method, &our_report, &seconds),
          std::tuple("20 x 50, " + plain_report.method, &plain_report, &plain_seconds)})
        fmt::print("  {:<22} {:>13} {:>7} {:>10.3f} {:>14.7g}\n", name, report->reweightings, report->iterations,
                   median(*times), report->objective);
    fmt::print("  default over 20 x 50: {:.2f} times faster (target 4), objective {:.6f} times (target at most 1)\n",
               median(ratios), objectives);
    fmt::print("  the first code took {} s at 1280x720 once: {:.1f} times ours (target 8)\n\n", first_code_seconds,
               over_first);
    return {{"size", problem.name()},
            {"method", our_report.method},
            {"reweightings", our_report.reweightings},
            {"iterations", our_report.iterations},
            {"plain_iterations", plain_report.iterations},
            {"seconds", spread(seconds)},
            {"plain_seconds", spread(plain_seconds)},
            {"times_faster", spread(ratios)},
            {"objective", our_report.objective},
            {"plain_objective", plain_report.objective},
            {"objective_over_plain", objectives}};
}

} // namespace gradus::bench
