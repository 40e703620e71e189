#include "driver/solve_report.h"

#include "driver/program.h"
#include "driver/statistics_json.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gradus {

std::string solve_report_text(const PoissonReport &report) {
    if (report.method == no_system)
        return fmt::format("method       none: without differences there is no system, pixels and guide are mixed\n"
                           "seconds      {:.3f}\n",
                           report.seconds);
    std::string text = fmt::format("method       {}\n", report.method);
    text += fmt::format("alpha        {:.6g}\n", report.alpha);
    text += fmt::format("iterations   {}", report.iterations);
    if (report.reweightings > 0)
        text += fmt::format(" in {} reweightings", report.reweightings);
    // L1 comes ever closer, and its count is what it takes as a rule.
    text += report.converged ? ", converged\n" : report.reweightings > 0 ? ", stopped by count\n" : ", not converged\n";
    if (!report.residuals.empty())
        text += fmt::format("residual     {:.3e}\n", report.residuals.back());
    text += fmt::format("objective    {:.6e}", report.objective);
    if (!report.objectives.empty())
        text += fmt::format(", at the start {:.6e}", report.objectives.front());
    text += fmt::format("\nmissing      primal {}, dx {}, dy {}; filled {}\n", report.missing_primal, report.missing_dx,
                        report.missing_dy, report.filled);
    double in_kernels = 0;
    for (const KernelTime &kernel : report.kernels)
        in_kernels += kernel.seconds;
    text += fmt::format("seconds      {:.3f}, {:.3f} of them in kernels\n", report.seconds, in_kernels);
    return text;
}

nlohmann::json solve_report_json(const SolveRecord &record, const PoissonReport &report) {
    nlohmann::json kernels = nlohmann::json::array();
    for (const KernelTime &kernel : report.kernels)
        kernels.push_back({{"name", kernel.name}, {"seconds", kernel.seconds}, {"launches", kernel.launches}});
    return {{"version", version()},
            {"method", report.method},
            {"reconstruction", record.reconstruction},
            {"norm", record.norm},
            {"weights", record.weights},
            {"alpha", report.alpha},
            {"width", record.width},
            {"height", record.height},
            {"channels", record.channels},
            {"device", device_json(record.device)},
            {"iterations", report.iterations},
            {"reweightings", report.reweightings},
            {"converged", report.converged},
            {"residuals", report.residuals},
            {"objective", report.objective},
            {"objectives", report.objectives},
            {"missing", {{"primal", report.missing_primal}, {"dx", report.missing_dx}, {"dy", report.missing_dy}}},
            {"filled", report.filled},
            {"correction", report.correction},
            {"kernels", kernels},
            {"memory", {{"device_bytes", report.device_bytes}, {"peak_host_bytes", peak_memory_bytes()}}},
            {"prepare_seconds", record.prepare_seconds},
            {"seconds", report.seconds},
            {"wall_seconds", record.wall_seconds}};
}

} // namespace gradus
