// Camera paths that go on as a path tracer's do while surfaces are too smooth to gather photons at, and leave a gather
// point at the first that is not.
#pragma once

#include "methods/method.h"
#include "runtime/wavefront/wavefront.h"

#include <cstdint>
#include <functional>

namespace gradus {

/// What camera paths to gather points ask of a session.
TraitMap gather_traits(const Scene &scene, const RenderOptions &options);

class GatherPaths {
  public:
    /// planes: paths of five planes of pixels (kernels/stages/camera.cl). Then gather points lie in the rows of their
    /// slots, and what the camera sees of lights is kept in `direct`.
    GatherPaths(Session &session, Stages &stages, const Scene &scene, const RenderOptions &options, bool planes);

    /// The paths', and `gather`.
    TableList tables() const;
    /// To be called once they are allocated.
    void attach(Tables &tables) { paths_.attach(tables); }

    /// Traces paths of slots [0, paths) to their end; slot 0 is that of pixel `first_pixel`. Calls `gathered` whenever
    /// there are new gather points, which lie in rows gather_points() of `gather` unless there are planes.
    void trace(std::uint32_t paths, std::uint32_t first_pixel, std::uint64_t pass,
               const std::function<void(const Hits &)> &gathered);
    /// Those of one BSDF kind.
    Range gather_points(const Hits &hits, std::size_t kind) const;
    std::size_t kinds() const { return paths_.kinds(); }

  private:
    void step(const Hits &hits);

    const Session &session_;
    bool samples_lights_, features_, planes_;
    bool has_smooth_; ///< surfaces that are no place to gather
    Stage &camera_, &far_clip_, &connect_;
    Wavefront paths_;
    Stage &escape_, &emission_, &travel_, &gather_, &shade_;
    Range gathered_; ///< rows of paths that have left a gather point and look for light
};

} // namespace gradus
