#include "bench/solver/measurements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace gradus::bench {

namespace {

/// One kind of solve at all sizes.
struct Series {
    const char *name;
    PoissonOptions options;
    std::map<std::uint32_t, int> iterations = {}; ///< by width
    std::vector<std::vector<double>> turns = {};  ///< seconds per pixel, by turn and size
};

std::vector<Series> series() {
    Series l2{"L2 to 1e-4", {}}, l1{"L1, 4 reweightings", {}};
    l2.options.norm = PoissonNorm::l2;
    l2.options.tolerance = 1e-4;
    // How many reweightings the tolerance takes depends on the image: a fixed number of them.
    l1.options.iterations = 4;
    l1.options.tolerance = 1e-12;
    return {l2, l1};
}

} // namespace

nlohmann::json measure_scaling(const Settings &settings, bool quick) {
    std::vector<Inputs> inputs;
    const std::vector<std::pair<int, int>> sizes = {
        {1280, 800}, {1920, 1080}, {2560, 1600}, {3840, 2160}, {5120, 3200}};
    for (std::size_t i = 0; i < (quick ? 3 : sizes.size()); ++i)
        inputs.push_back(make_inputs(sizes[i].first, sizes[i].second));
    std::vector<Series> all = series();
    for (int turn = 0; turn < settings.repeats; ++turn) {
        for (Series &s : all)
            s.turns.emplace_back();
        for (const Inputs &of_size : inputs) {
            Problem problem(settings, of_size); // one at a time: the largest takes gigabytes
            for (Series &s : all) {
                s.iterations[of_size->width] = problem.solve(s.options).report.iterations; // first use of its memory
                s.turns.back().push_back(problem.solve(s.options).seconds / double(of_size->pixels()));
            }
        }
    }
    nlohmann::json results = nlohmann::json::array();
    for (const Series &s : all) {
        fmt::print("Time by pixels, {}\n  {:<12} {:>8} {:>7} {:>10} {:>14}\n", s.name, "size", "Mpixel", "steps",
                   "seconds", "ns per pixel");
        nlohmann::json rows = nlohmann::json::array();
        for (std::size_t i = 0; i < inputs.size(); ++i) {
            const std::string name = fmt::format("{}x{}", inputs[i]->width, inputs[i]->height);
            const double pixels = double(inputs[i]->pixels());
            const int iterations = s.iterations.at(inputs[i]->width);
            std::vector<double> by_pixel;
            for (const std::vector<double> &turn : s.turns)
                by_pixel.push_back(turn[i]);
            fmt::print("  {:<12} {:>8.2f} {:>7} {:>10.3f} {:>14.1f}\n", name, 1e-6 * pixels, iterations,
                       pixels * median(by_pixel), 1e9 * median(by_pixel));
            rows.push_back({{"size", name},
                            {"pixels", inputs[i]->pixels()},
                            {"iterations", iterations},
                            {"seconds_per_pixel", spread(by_pixel)}});
        }
        std::vector<double> ratios;
        for (const std::vector<double> &turn : s.turns)
            ratios.push_back(*std::max_element(turn.begin(), turn.end()) / *std::min_element(turn.begin(), turn.end()));
        fmt::print("  largest over least time per pixel: {:.2f} (target 1.2)\n\n", median(ratios));
        results.push_back({{"kind", s.name}, {"sizes", rows}, {"largest_over_least", spread(ratios)}});
    }
    return results;
}

} // namespace gradus::bench
