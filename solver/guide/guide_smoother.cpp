#include "solver/guide/guide_smoother.h"

#include "runtime/error.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

namespace gradus::solver {

namespace {

struct GuideKernel {
    const char *file, *entry;
    int taps;
};
constexpr GuideKernel guide_kernels[] = {
    {"guide_filter", "guide_distances", 0},      {"guide_filter", "guide_gather", 0},
    {"guide_filter", "guide_export", 0},         {"guide_input", "guide_import", 0},
    {"guide_input", "guide_prepare", 0},         {"guide_input", "guide_import_features", 0},
    {"guide_judge", "guide_moments", 0},         {"guide_judge", "guide_share", 0},
    {"guide_judge", "guide_blend", 0},           {"guide_smooth", "guide_smooth_rows", 3},
    {"guide_smooth", "guide_smooth_columns", 3}, {"guide_smooth", "guide_smooth_rows", 9},
    {"guide_smooth", "guide_smooth_columns", 9}, {"guide_light", "guide_lost", 0},
    {"guide_light", "guide_light_pass", 0},      {"guide_light", "guide_give_back", 0},
};

KernelLibrary guide_library(Device &device, Precision precision) {
    return {device, {{"SOLVER_CHANNELS", 3}, {"SOLVER_WEIGHTED", 0}, {"SOLVER_JOINT", 1}}, precision};
}

KernelRequest guide_request(const GuideKernel &kernel) {
    KernelRequest request{kernel.entry, fmt::format("kernels/solver/{}.cl", kernel.file), kernel.entry, {}};
    if (kernel.taps > 0)
        request.definitions["GUIDE_TAPS"] = fmt::format("{}", kernel.taps);
    return request;
}

} // namespace

Grid guide_grid(std::uint32_t width, std::uint32_t height) {
    if (width == 0 || height == 0)
        throw Error(ExitCode::usage, "a guided image needs a width and a height");
    return {width, height};
}

Kernel guide_kernel(Device &device, Precision precision, const char *file, const char *entry, int taps) {
    return std::move(guide_library(device, precision).build({guide_request({file, entry, taps})}).front());
}

void compile_guide_kernels(Device &device, const KernelLibrary::Progress &progress) {
    std::vector<KernelRequest> requests;
    for (const GuideKernel &kernel : guide_kernels)
        requests.push_back(guide_request(kernel));
    guide_library(device, Precision::single).build(requests, progress);
}

GuideSmoother::GuideSmoother(const PlaneMaker &make, const Grid &grid, int radius, double sigma)
    : make_(make), grid_(grid),
      rows_(guide_kernel(make.device(), make.precision(), "guide_smooth", "guide_smooth_rows", radius)),
      columns_(guide_kernel(make.device(), make.precision(), "guide_smooth", "guide_smooth_columns", radius)) {
    std::vector<double> taps;
    for (int d = -radius; d <= radius; ++d)
        taps.push_back(std::exp(-0.5 * d * d / (sigma * sigma)));
    taps_ = make.reals("taps", taps);
}

void GuideSmoother::run(const Buffer &image, const Buffer &smoothed, std::uint32_t planes) {
    const std::size_t bytes = std::size_t(grid_.plane) * planes * real_bytes(make_.precision());
    if (!across_.valid() || across_.bytes() < bytes)
        across_ = make_.planes("smoothed", grid_, planes);
    rows_.bind(taps_);
    rows_.bind("image", image);
    rows_.bind("smoothed", across_);
    grid_.launch(rows_, {0, planes});
    columns_.bind(taps_);
    columns_.bind("image", across_);
    columns_.bind("smoothed", smoothed);
    grid_.launch(columns_, {0, planes});
}

} // namespace gradus::solver
