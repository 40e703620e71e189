// Stochastic progressive photon mapping (Hachisuka and Jensen 2009), as wavefronts.
//
// Each pass traces light paths, which leave photons (light_paths.h), and one camera path a pixel. That goes on as a
// path tracer's does while surfaces are too smooth to gather at, and leaves a gather point at the first that is not.
// What the photons within a disc around it carry, over the disc's area, is the light that the surface sends on.
//
// The disc's radius goes with what a pixel covers there, and shrinks from pass to pass by a rule that knows the pass
// alone (Knaus and Zwicker 2011): so no pass depends on those before it, no pixel has a state, and neighbouring gather
// points have like radii.
//
// Which kind of path is made by what (E the eye, L a light, S smooth vertices, D the first vertex from the eye that is
// rough, X any):
//   L S* E        camera paths, which find the light; light sampling too where S is glossy, weighted as in pt
//   L D S* E      light sampling and one more ray from D, weighted as in pt; with direct photons, photons
//   L X X* D S* E photons
#pragma once

#include "methods/method.h"
#include "methods/photons/gather_paths.h"
#include "methods/photons/pass_photons.h"
#include "methods/photons/photon_pairs.h"
#include "methods/photons/radius_bias.h"
#include "runtime/wavefront/film.h"

#include <memory>
#include <optional>

namespace gradus {

class PhotonMapper final : public Method {
  public:
    /// Throws Error(ExitCode::usage) where nothing can be gathered: without a light, or without a rough surface.
    PhotonMapper(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    std::uint64_t frame_samples() const override { return session_.pixels(); }
    bool render_batch() override;
    Image image() override;
    Statistics statistics() const override;

    Tracer *tracer() override { return &session_.tracer; }

  private:
    void allocate();
    void gather_photons(const Hits &hits);

    RenderOptions options_;
    Session session_;
    Stages stages_;
    GatherPaths paths_;
    PassPhotons photons_;
    PhotonPairs pairs_;
    Stage &evaluate_, &add_;
    RadiusBias bias_;
    Film film_;
    std::optional<Tables> tables_;

    std::uint64_t total_ = 0, done_ = 0;
    std::uint32_t camera_paths_ = 0; ///< at once, but for the last of a pass
    Statistics statistics_;
};

std::unique_ptr<Method> make_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
