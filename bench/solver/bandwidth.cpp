#include "bench/solver/measurements.h"
#include "bench/solver/triad.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <map>

namespace gradus::bench {

namespace {

/// How often a kernel of a step (solver/linear_solver.cpp) goes through an array of all channels, from reading
/// kernels/solver/conjugate_gradient.cl and sum.cl. A neighbour's value in a stencil comes from the cache.
struct Traffic {
    double needed; ///< by conjugate gradients in any form: the vectors, each read or written once by a kernel
    double moved;  ///< with the sums and their parts
    int launches;  ///< a step, for all channels together or for each; 0: as the size of the image asks for
};

const std::map<std::string, Traffic> traffic_of_step = {
    // Reads z and the old direction, writes direction and image, and a part of <direction, image> for each eight.
    {"direction", {4, 4.125, 1}},
    {"advance", {6, 6, 1}},              // reads direction and image, reads and writes u and residual
    {"reduce_products", {0, 1.0625, 1}}, // <residual, residual>: reads it, writes a sixteenth
    // Reads that eighth and that sixteenth, writes a sixteenth of each; the same of what it wrote, and so on.
    {"reduce", {0, (1 / 8. + 1 / 16.) * (1 + 1 / 16.) / (1 - 1 / 16.), 0}},
    {"finish_sum", {0, 0, 2}}}; // of both sums

constexpr int vectors = 5; // z (the residual), two directions, image, u
// The residual is computed anew in the 50th step, so both counts are below.
constexpr int few_steps = 5, many_steps = 45;
constexpr double steps = many_steps - few_steps;

std::map<std::string, KernelTime> by_name(const PoissonReport &report) {
    std::map<std::string, KernelTime> result;
    for (const KernelTime &time : report.kernels)
        result[time.name] = time;
    return result;
}

} // namespace

nlohmann::json measure_bandwidth(const Settings &settings, Problem &problem) {
    const PoissonOptions few = l2_steps(LinearMethod::cg, few_steps), many = l2_steps(LinearMethod::cg, many_steps);
    problem.solve(many);
    const double array = double(problem.pixels()) * channels * sizeof(float);
    double needed = 0, moved = 0;
    for (const auto &[name, traffic] : traffic_of_step) {
        needed += traffic.needed * array;
        moved += traffic.moved * array;
    }
    std::vector<double> triads, step_seconds, needed_shares, moved_shares;
    std::map<std::string, std::vector<double>> kernel_seconds;
    for (int turn = 0; turn < settings.repeats; ++turn) {
        triads.push_back(triad_bandwidth(std::size_t(vectors * array), settings.threads));
        const Problem::Run short_run = problem.solve(few), long_run = problem.solve(many);
        step_seconds.push_back((long_run.seconds - short_run.seconds) / steps);
        needed_shares.push_back(needed / step_seconds.back() / triads.back());
        moved_shares.push_back(moved / step_seconds.back() / triads.back());
        auto before = by_name(short_run.report);
        for (const auto &[name, time] : by_name(long_run.report)) {
            if (time.launches == before[name].launches)
                continue; // not a part of the step
            if (!traffic_of_step.contains(name))
                throw Error(ExitCode::failure, "bench/solver/bandwidth.cpp has no bytes for kernel " + name);
            const int expected = traffic_of_step.at(name).launches;
            const double launches = double(time.launches - before[name].launches) / steps;
            if (expected > 0 && launches != expected && launches != expected * channels)
                throw Error(ExitCode::failure,
                            fmt::format("bench/solver/bandwidth.cpp expects {} launches of kernel {} a step, not {}",
                                        expected, name, launches));
            kernel_seconds[name].push_back((time.seconds - before[name].seconds) / steps);
        }
        for (const auto &[name, traffic] : traffic_of_step)
            if (!kernel_seconds.contains(name))
                throw Error(ExitCode::failure, "a step has no kernel " + name + ", see bench/solver/bandwidth.cpp");
    }
    fmt::print("A step of conjugate gradients, {} RGB, against a triad over as much memory ({:.1f} GB/s)\n",
               problem.name(), 1e-9 * median(triads));
    fmt::print("  {:<14} {:>13} {:>12} {:>10} {:>14} {:>13}\n", "kernel", "bytes needed", "and moved", "us",
               "needed/triad", "moved/triad");
    nlohmann::json rows = nlohmann::json::array();
    const double pixels = double(problem.pixels());
    const auto row = [&](const std::string &name, double bytes_needed, double bytes_moved, double seconds) {
        fmt::print("  {:<14} {:>13.0f} {:>12.0f} {:>10.0f} {:>12.0f} % {:>11.0f} %\n", name, bytes_needed / pixels,
                   bytes_moved / pixels, 1e6 * seconds, 100 * bytes_needed / seconds / median(triads),
                   100 * bytes_moved / seconds / median(triads));
    };
    for (const auto &[name, seconds] : kernel_seconds) {
        const Traffic traffic = traffic_of_step.at(name);
        row(name, traffic.needed * array, traffic.moved * array, median(seconds));
        rows.push_back({{"kernel", name},
                        {"bytes_needed_per_pixel", traffic.needed * array / pixels},
                        {"bytes_moved_per_pixel", traffic.moved * array / pixels},
                        {"seconds", spread(seconds)}});
    }
    row("step", needed, moved, median(step_seconds));
    fmt::print("  a step reaches {:.0f} % of the triad for the bytes it needs (target 70 %), {:.0f} % for those it "
               "moves\n\n",
               100 * median(needed_shares), 100 * median(moved_shares));
    return {{"size", problem.name()},
            {"triad_bytes_per_second", spread(triads)},
            {"step_seconds", spread(step_seconds)},
            {"needed_over_triad", spread(needed_shares)},
            {"moved_over_triad", spread(moved_shares)},
            {"kernels", rows}};
}

} // namespace gradus::bench
