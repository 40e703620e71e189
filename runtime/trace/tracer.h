// Intersecting rays in batches. Embree is known in this folder alone, and not from this file.
#pragma once

#include "runtime/scene/scene.h"
#include "runtime/trace/ray_order.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace gradus {

/// The host's view of the columns of a ray table: see GRADUS_RAY_COLUMNS.
struct RayColumns : SegmentColumns {
    /// In: ray_pending, ray_unhindered or ray_none; out: what was hit, or ray_escaped.
    std::uint32_t *primitive = nullptr;
    /// Out, of what was hit: the record of its instance (SceneTables::no_instance); null where there are none.
    std::uint32_t *instance = nullptr;
    /// Out, where asked for: the opacity of what was hit, there, in ray_opacity_one. A surface of opacity 0.5 is hit by
    /// half of the rays, and photons on it are half of those that arrive.
    std::uint32_t *opacity = nullptr;
    /// Whoever traces a path's segments again, by rays that differ in rounding, may not have chance decide anew: these
    /// meet whatever is not open altogether, and find nothing (ray_none) where chance would have decided.
    bool without_chance = false;
};

/// The host's view of the columns of a shadow table: see GRADUS_SHADOW_COLUMNS.
struct ShadowColumns : SegmentColumns {
    std::uint32_t *open = nullptr; ///< in: 1 asks for a trace; out: 1 if nothing lies before parameter 1
};

struct SceneTables; // runtime/scene/scene_tables.h

struct TraceCounts {
    std::uint64_t extension = 0, shadow = 0;
};

/// How recorded rays go to Embree again: in the packets and with the flags of the render; in the same packets, but
/// never as beams; one by one.
enum class ReplayedAs { traced, packets, single };

struct Replayed {
    double seconds = 0;
    std::uint64_t rays = 0;
};

class Tracer {
  public:
    /// Builds the acceleration structures. Primitives are numbered triangles first (mesh by mesh in the order of
    /// Scene::shapes), then spheres in that order. `threads`: 0 for all. Vertices and indices are those of `tables`,
    /// where it has them and they outlive the tracer, and copies else. Throws Error where memory is short.
    Tracer(const Scene &scene, int threads, const SceneTables *tables = nullptr);
    ~Tracer();

    /// Traces rows [0, rays) and [0, shadows), on all threads; returns how many were really traced. Which hit a ray
    /// gets depends on the ray alone (docs/design.md, "The same image, always", has the exception). Rows that are alike
    /// (SegmentColumns::line) go side by side.
    TraceCounts trace(const RayColumns &ray, std::size_t rays, const ShadowColumns &shadow, std::size_t shadows);

    /// Runs `work` on the parts [begin, end) of [0, count), on the threads that trace.
    void in_parallel(std::size_t count, const std::function<void(std::size_t begin, std::size_t end)> &work);

    void set_order(RayOrder extension, RayOrder shadow);

    /// From now on keeps the packets of every `interval`-th call of trace(); 0 stops that.
    void record(std::size_t interval);
    /// Traces what was recorded once more.
    Replayed replay(ReplayedAs as);

    std::size_t memory_bytes() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace gradus
