// Gradient-domain path tracing (Kettunen et al. 2015): beside each pixel's path, four offset paths through its
// neighbours, and an image reconstructed from colours and differences.
//
// All pixels of a sample share their place within the pixel, so an offset path begins where the neighbour's own path
// does. Where it and the base path are at rough vertices it reconnects to the base path's next one, and merges with it
// there: from the vertex after that on both are the same, and what they differ by is kept by slot. So the base path's
// later stages are the path tracer's. Until then an offset path copies the base path's half vectors and has vertices of
// its own; scenes in which all surfaces are rough do without.
#pragma once

#include "runtime/methods/direct_light.h"
#include "runtime/methods/path_tracer.h"
#include "solver/poisson_solver.h"

#include <future>
#include <memory>
#include <optional>

namespace gradus {

class GradientPathTracer final : public PathTracer {
  public:
    GradientPathTracer(Device &device, const Scene &scene, const RenderOptions &options);

    bool render_batch() override;
    /// R, G, B reconstructed; with `layers` then direct, primal, dx, dy, and with aov also their variances; with aov
    /// the path tracer's layers.
    Image image() override { return make_image(options_.layers, false); }
    Image last_image() override { return make_image(options_.layers, true); }
    Image image_with_layers() { return make_image(true, false); }
    void restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel) override;
    Statistics statistics() const override;

  private:
    /// What becomes of offset paths at a vertex: at the first, all are apart; then some are; then the last reconnect;
    /// later all are merged.
    enum Phase { first, apart, joined, later, phases };

    struct GradientKernels {
        Kernel light_first, light_apart, light_joined, scatter_apart, scatter_joined;
    };
    struct Range {
        std::uint32_t first = 0, count = 0;
        std::uint32_t end() const { return first + count; }
    };
    /// Where the partition put paths. Rows are those of the vertices that `surface` makes; a row's place in the index
    /// is `escaped_count` further on.
    struct Vertices {
        std::uint32_t count = 0, escaped_count = 0;
        Range escaped[phases]; ///< places in the index
        Range rows[phases];
        std::vector<Range> kinds[phases];    ///< rows by kind
        std::vector<Range> emitting[phases]; ///< those of them on surfaces that emit
        /// Rows with offset paths that are apart: they come first.
        std::uint32_t shifting() const { return rows[apart].end(); }
    };
    /// Offset paths on their way from one vertex to the next: what they ask the tracer, and where `shift` put them.
    struct Shifting {
        Range index;
        std::uint32_t to = 0;           ///< first row of `shifted`
        std::uint32_t link_first = 0;   ///< first row of `link`, offset by offset
        std::uint32_t offset_first = 0; ///< the same of `offset_ray`
    };
    struct Shiftings {
        Shifting surface[phases], escaped[phases];
        std::uint32_t links = 0, offset_rays = 0;
    };

    std::vector<Wanted> wanted_kernels();
    void allocate();
    void bind_kernels();
    void trace_primaries(std::uint32_t paths);
    /// Classifies and sorts the rays of `vertices` and `fresh` new ones.
    Vertices partition(const Vertices &vertices, std::uint32_t fresh, const Buffer &vertex);
    Shiftings shift(const Vertices &vertices, const Vertices &next);
    void connect(const Vertices &vertices, const Buffer &vertex);
    void emit(const Vertices &next, const Shiftings &shiftings);
    void scatter(const Vertices &vertices, const Buffer &vertex);

    /// `last`: lets go of batches and films as soon as they have been read.
    Image make_image(bool layers, bool last);
    void release_batch();

    void count_outcomes(Range rows);
    bool keeps_apart() const { return traits_.at("TRAIT_APART") != 0; }
    bool keeps_distance() const { return traits_.at("TRAIT_SHIFT_DISTANCE") != 0; }

    Kernel primary_begin_, primary_surface_, begin_, settle_, close_links_, offset_begin_, offset_surface_;
    Kernel clear_, connect_first_, connect_apart_, connect_joined_, combine_, gradient_accumulate_, count_;
    Kernel shift_[2], shift_escaped_[2], offset_emission_[2],
        offset_escape_[2]; ///< [1]: where offset paths may be apart
    std::vector<GradientKernels> gradient_kinds_;
    std::optional<std::vector<DirectPixel>> direct_edges_; ///< once sampled: a restart needs no others
    std::uint64_t edge_rays_ = 0;
    std::unique_ptr<PoissonSolver> solver_;
    std::future<void> solver_compiled_; ///< while the first samples render
    Buffer material_kind_, primary_, gain_, link_, prefix_, difference_, direct_, gradient_film_;
    Buffer shifted_[2]; ///< as BatchTables::vertex; the same where none stay apart
    Buffer offset_vertex_, offset_ray_, offset_state_, offset_reach_;
    Buffer outcome_;
};

} // namespace gradus
