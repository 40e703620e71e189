#include "bench/solver/measurements.h"
#include "bench/solver/rival.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gradus::bench {

namespace {

struct Point {
    int count; ///< steps, cycles or reweightings
    double value = 0;
    std::vector<double> seconds = {};
};

/// A method with the counts at which it is stopped and looked at.
struct Curve {
    std::string name;
    PoissonOptions options;
    std::vector<int> counts;
    std::vector<Point> points;
};

std::vector<int> powers(int base, int largest) {
    std::vector<int> counts;
    for (int count = 1; count <= largest; count *= base)
        counts.push_back(count);
    return counts;
}

double finite(double value, const std::string &of) {
    if (!std::isfinite(value))
        throw Error(ExitCode::failure, of + " gave no finite image");
    return value;
}

/// Finds the points: more and more iterations, until they take too long. Then the other turns. `value` is what a run
/// is worth; less is better.
template <class Value>
void trace(const Settings &settings, Problem &problem, std::vector<Curve> &curves, double longest, Value value) {
    for (Curve &curve : curves) {
        curve.options.iterations = curve.counts.front();
        problem.solve(curve.options); // kernels, caches
        for (const int count : curve.counts) {
            curve.options.iterations = count;
            const Problem::Run run = problem.solve(curve.options);
            curve.points.push_back({count, finite(value(run), curve.name), {run.seconds}});
            if (run.seconds > longest)
                break;
        }
    }
    for (int turn = 1; turn < settings.repeats; ++turn)
        for (Curve &curve : curves)
            for (Point &point : curve.points) {
                curve.options.iterations = point.count;
                point.seconds.push_back(problem.solve(curve.options).seconds);
            }
}

nlohmann::json points_json(const Curve &curve, const char *value_name) {
    nlohmann::json points = nlohmann::json::array();
    for (const Point &point : curve.points)
        points.push_back({{"count", point.count}, {"seconds", spread(point.seconds)}, {value_name, point.value}});
    return {{"method", curve.name}, {"points", points}};
}

void print(const Curve &curve) {
    fmt::print("  {:<22}", curve.name);
    // The last, and up to three before it, evenly spaced.
    const std::size_t step = std::max<std::size_t>(1, curve.points.size() / 4);
    for (std::size_t i = (curve.points.size() - 1) % step; i < curve.points.size(); i += step)
        fmt::print("{:>6}: {:.3f} s {:<9.3g}", curve.points[i].count, median(curve.points[i].seconds),
                   curve.points[i].value);
    fmt::print("\n");
}

nlohmann::json l2_curves(const Settings &settings, Problem &problem) {
    std::vector<Curve> curves;
    curves.push_back({"jacobi", l2_steps(LinearMethod::jacobi, 1), powers(4, 4096), {}});
    curves.push_back({"cg", l2_steps(LinearMethod::cg, 1), powers(2, 1024), {}});
    for (const LinearMethod method : {LinearMethod::pcg, LinearMethod::multigrid})
        curves.push_back({method_name(method), l2_steps(method, 1), {1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20}, {}});
    trace(settings, problem, curves, settings.longest,
          [&](const Problem::Run &) { return problem.error(problem.image()); });

    Rival rival(problem.width(), problem.height(), channels, settings.threads);
    Curve direct{"FFTW DCT, float", {}, {}, {}};
    direct.points.push_back({1});
    const float *result = nullptr;
    for (int turn = 0; turn < settings.repeats; ++turn)
        direct.points[0].seconds.push_back(seconds_of([&] { result = rival.solve(problem.images(), chart_alpha); }));
    direct.points[0].value = problem.error({result, result + channels * problem.pixels()});
    curves.push_back(direct);

    fmt::print("L2, {} RGB: steps or cycles, seconds, relative error to the double DCT\n", problem.name());
    nlohmann::json json = nlohmann::json::array();
    for (const Curve &curve : curves) {
        print(curve);
        json.push_back(points_json(curve, "error"));
    }
    return json;
}

nlohmann::json l1_curves(const Settings &settings, Problem &problem) {
    PoissonOptions ours;
    ours.alpha = chart_alpha;
    ours.tolerance = 1e-12;
    ours.keep_mean = false; // the objective is without it
    PoissonOptions plain = ours;
    plain.method = LinearMethod::cg;
    plain.inner_iterations = 50;
    const std::vector<int> counts = {1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64};
    std::vector<Curve> curves = {{"default", ours, counts, {}}, {"reweightings of 50 cg", plain, counts, {}}};
    trace(settings, problem, curves, 5 * settings.longest,
          [](const Problem::Run &run) { return run.report.objective; });

    // Where the default stops of its own accord.
    Curve stop{"default, as it stops", {}, {}, {}};
    ours.tolerance = 0;
    ours.iterations = 0;
    const Problem::Run run = problem.solve(ours);
    stop.points.push_back({run.report.reweightings, run.report.objective, {run.seconds}});
    for (int turn = 1; turn < settings.repeats; ++turn)
        stop.points[0].seconds.push_back(problem.solve(ours).seconds);
    curves.push_back(stop);

    fmt::print("L1, {} RGB: reweightings, seconds, objective\n", problem.name());
    nlohmann::json json = nlohmann::json::array();
    for (const Curve &curve : curves) {
        print(curve);
        json.push_back(points_json(curve, "objective"));
    }
    fmt::print("\n");
    return json;
}

} // namespace

nlohmann::json measure_curves(const Settings &settings, Problem &problem) {
    const nlohmann::json l2 = l2_curves(settings, problem), l1 = l1_curves(settings, problem);
    return {{"size", problem.name()}, {"pixels", problem.pixels()}, {"l2", l2}, {"l1", l1}};
}

} // namespace gradus::bench
