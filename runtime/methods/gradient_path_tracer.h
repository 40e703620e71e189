// Gradient-domain path tracing (Kettunen et al. 2015): beside each pixel's path, four offset paths through its
// neighbours, and an image reconstructed from colours and differences.
//
// All pixels of a sample share their place within the pixel, so an offset path begins where the neighbour's own path
// does. It reconnects to the base path at its second vertex and merges with it there: from the third vertex on both are
// the same, and what they differ by is kept by slot. So the base path's later stages are the path tracer's. Phases tell
// vertices apart: 0 is the first vertex of a path, 1 the second, 2 any later one.
#pragma once

#include "runtime/methods/path_tracer.h"
#include "solver/poisson_solver.h"

#include <memory>

namespace gradus {

class GradientPathTracer final : public PathTracer {
  public:
    GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options);

    bool render_batch() override;
    /// R, G, B reconstructed, then layers primal, dx, dy, direct; with aov also their variances and the path tracer's
    /// layers.
    Image image() override;
    void restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) override;

  private:
    static constexpr std::uint32_t phases = 3;

    struct GradientKernels {
        Kernel light_first, light_second, scatter_first, scatter_second;
    };
    struct Range {
        std::uint32_t first = 0, count = 0;
    };
    /// Where the partition put paths. Rows are those of the vertices that `surface` makes; a row's place in the index
    /// is `escaped_count` further on.
    struct Vertices {
        std::uint32_t count = 0, escaped_count = 0;
        Range escaped[phases]; ///< places in the index
        Range rows[phases];
        std::vector<Range> kinds[phases];    ///< rows by kind
        std::vector<Range> emitting[phases]; ///< those of them on surfaces that emit
    };

    std::vector<Wanted> wanted_kernels();
    void allocate();
    void bind_kernels();
    void trace_primaries(std::uint32_t paths);
    void connect(const Vertices &vertices, const Buffer &vertex);
    void emit(const Vertices &next, std::uint32_t link_first);
    /// Classifies and sorts the rays.
    Vertices partition(std::uint32_t rays, const Buffer &vertex);

    Kernel primary_begin_, primary_surface_, begin_, shift_, shift_escaped_, settle_, close_links_;
    Kernel emission_second_, escape_second_, connect_first_, connect_second_, combine_, gradient_accumulate_;
    std::vector<GradientKernels> gradient_kinds_;
    std::vector<std::uint32_t> kind_numbers_; ///< of GRADUS_BSDF_KINDS
    std::unique_ptr<PoissonSolver> solver_;
    Buffer primary_, shifted_, gain_, link_, prefix_, difference_, direct_, gradient_film_;
};

} // namespace gradus
