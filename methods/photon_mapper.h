// Stochastic progressive photon mapping (Hachisuka and Jensen 2009), as wavefronts.
//
// Each pass traces light paths, which leave photons (light_paths.h), and one camera path a pixel. That goes on as a
// path tracer's does while surfaces are too smooth to gather at, and leaves a gather point at the first that is not.
// What the photons within a disc around it carry, over the disc's area, is the light that the surface sends on.
//
// The disc's radius goes with what a pixel covers there, and shrinks from pass to pass by a rule that knows the pass
// alone (Knaus and Zwicker 2011): so passes are independent samples, no pixel has a state, and neighbouring gather
// points have like radii.
//
// Which kind of path is made by what (E the eye, L a light, S smooth vertices, D the first vertex from the eye that is
// rough, X any):
//   L S* E        camera paths, which find the light; light sampling too where S is glossy, weighted as in pt
//   L D S* E      light sampling and one more ray from D, weighted as in pt; with direct photons, photons
//   L X X* D S* E photons
#pragma once

#include "methods/light_paths.h"
#include "methods/method.h"
#include "methods/photon_map.h"
#include "methods/photon_pairs.h"
#include "runtime/wavefront/film.h"
#include "runtime/wavefront/wavefront.h"

#include <memory>
#include <optional>

namespace gradus {

/// The square of the radius of pass `pass`, from 0 on, over that of the first: Knaus and Zwicker 2011, eq. 20.
double radius_shrinkage(std::uint64_t pass, double alpha);

class PhotonMapper final : public Method {
  public:
    /// Throws Error(ExitCode::usage) where nothing can be gathered: without a light, or without a rough surface.
    PhotonMapper(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    bool render_batch() override;
    Image image() override;
    Statistics statistics() const override;

    Tracer *tracer() override { return &session_.tracer; }

  private:
    void allocate();
    /// The photons of a pass, in order, and its radius.
    void begin_pass(std::uint64_t pass);
    void trace_camera_paths(std::uint32_t paths, std::uint32_t first_pixel, std::uint64_t pass);
    /// The surfaces that the partition found are the newest vertices, and some of them gather points.
    void step(const Hits &hits);
    void gather_photons(const Hits &hits);

    RenderOptions options_;
    Session session_;
    bool has_smooth_; ///< surfaces that are no place to gather
    Stages stages_;
    Stage &camera_, &connect_;
    Wavefront paths_;
    Stage &escape_, &emission_, &travel_, &gather_, &shade_;
    LightPaths light_paths_;
    PhotonMap map_;
    PhotonPairs pairs_;
    Stage &evaluate_, &add_;
    Film film_;
    std::optional<Tables> tables_;

    std::uint64_t total_ = 0, done_ = 0;
    std::uint32_t camera_paths_ = 0; ///< at once, but for the last of a pass
    std::uint32_t paths_a_pass_ = 0; ///< light paths
    std::uint64_t photons_of_pass_ = ~0ull;
    double typical_radius_ = 0, largest_radius_ = 0; ///< of the first pass
    Range gathered_;                                 ///< rows of paths that have left a gather point and look for light
    Statistics statistics_;
};

std::unique_ptr<Method> make_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
