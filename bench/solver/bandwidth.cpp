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
    double moved;  ///< with the sums, which read their vectors again
};

const std::map<std::string, Traffic> traffic_of_step = {
    {"direction", {4, 4}},          // reads z and the old direction, writes direction and image
    {"advance", {6, 6}},            // reads direction and image, reads and writes u and residual
    {"reduce_products", {0, 3.13}}, // <direction, image> and <residual, residual> | a sixteenth written for each
    {"reduce", {0, 0.14}},          // reads that, writes a sixteenth of it
    {"finish_sum", {0, 0}}};

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
            kernel_seconds[name].push_back((time.seconds - before[name].seconds) / steps);
        }
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
