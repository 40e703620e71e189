// Unidirectional path tracing with light sampling, multiple importance sampling and Russian roulette (Kajiya 1986,
// Veach 1997), as a wavefront.
#pragma once

#include "runtime/methods/method.h"
#include "runtime/stages/batch_tables.h"
#include "runtime/stages/film_stage.h"
#include "runtime/stages/partition_stage.h"
#include "runtime/stages/scene_buffers.h"
#include "runtime/trace/tracer.h"

#include <chrono>
#include <functional>
#include <optional>

namespace gradus {

class PathTracer : public Method {
  public:
    PathTracer(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    bool render_batch() override;
    Image image() override;
    Statistics statistics() const override;

    /// Forgets all samples; the next ones are of numbers [first_sample, first_sample + samples_per_pixel) of each
    /// pixel. Other numbers are other random paths of the same seed. A new method is at number 0.
    virtual void restart(std::uint64_t first_sample, std::uint64_t samples_per_pixel);

    /// For measuring: the tracer records and replays the rays of a render.
    Tracer &tracer() { return tracer_; }

  protected:
    /// The kernels of one BSDF kind.
    struct KindKernels {
        Kernel light_sample, scatter, feature;
        bool is_dirac = false;
    };
    /// A kernel to build, and where to keep it.
    struct Wanted {
        Kernel *place;
        KernelRequest request;
    };
    /// What a method built on this one adds.
    struct Additions {
        std::uint32_t phases = 1;  ///< of `classify`
        bool whole_frames = false; ///< a pass is some samples of every pixel
        std::vector<Wanted> kernels;
        std::function<void()> bind; ///< sets their arguments that are not common to all
    };
    /// To be followed by prepare().
    PathTracer(Device &device, const Scene &scene, const RenderOptions &options, const TraitMap &more_traits);
    void prepare(const Additions &additions);
    /// Sets what all kernels need.
    void bind_common(Kernel &kernel) const;
    /// Sets which pixel a slot belongs to.
    void bind_film_place(Kernel &kernel) const;
    static KernelRequest request_of(const std::string &stage);
    /// For one kind of BSDF.
    static KernelRequest request_of(const std::string &stage, const std::string &kind);

    void build_kernels(const std::vector<std::string> &kinds, const Additions &additions);
    void warm(std::vector<Kernel *> kernels);
    std::vector<Kernel *> all_kernels();
    bool escape_wanted() const { return traits_.at("TRAIT_ENVIRONMENT") != 0; }
    bool emission_wanted() const { return traits_.at("TRAIT_LIGHT_TRIANGLE") || traits_.at("TRAIT_LIGHT_SPHERE"); }
    std::uint32_t max_depth() const;
    bool samples_lights(bool is_dirac) const;
    void begin_paths(std::uint32_t row, std::uint32_t slot, std::uint32_t count, const Buffer &vertex);
    void trace(std::uint32_t rays, std::uint32_t shadows);
    /// Launches a kernel, where there is one, on rows [first, first + items).
    static void run(Kernel &kernel, std::uint32_t first, std::uint32_t items);
    /// How many paths the next pass has; tells `camera` where they begin.
    std::uint32_t begin_pass();
    /// Waits for a pass of so many paths and counts it. False once all samples are done.
    bool end_pass(std::uint32_t paths, std::chrono::steady_clock::time_point start);

    Device &device_;
    RenderOptions options_;
    RenderSettings settings_;
    FilmSettings film_settings_;
    TraitMap traits_;
    SceneTables scene_tables_;
    Tracer tracer_;
    std::uint64_t total_ = 0, done_ = 0, first_sample_ = 0;
    std::uint32_t pass_ = 0; ///< paths of a pass, but for the last
    std::optional<BatchTables> tables_;
    std::optional<SceneBuffers> scene_buffers_;
    std::optional<FilmStage> film_;
    std::optional<PartitionStage> partition_;
    std::vector<Kernel> partition_kernels_;
    Kernel camera_, classify_, surface_, escape_, connect_, emission_, accumulate_;
    std::vector<Kernel *> more_kernels_; ///< of a method built on this one
    std::vector<KindKernels> kinds_;     ///< in the order of SceneTables::kinds
    Statistics statistics_;
    double trace_seconds_ = 0;
};

} // namespace gradus
