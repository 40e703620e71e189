// Gradient-domain photon density estimation (Hua et al. 2017): photon mapping as in photon_mapper.h, and beside it the
// differences to the four neighbours, from which the image is reconstructed.
//
// A path is a camera path to its gather point and a light path to a photon near it; both are shifted by themselves.
//
// The offset camera path is that of the neighbour with the base path's random numbers: in the space of these numbers it
// has the base path's density and Jacobian 1, cannot fail, and is its own way back; and all that camera paths find on
// their way, light samples included, is shifted by the same stages. (The paper copies half vectors, which does nearly
// the same where a surface is smooth, but fails where an event differs or light is totally reflected.)
//
// A photon that counts at both gather points stays; one that does not is mirrored, and its last vertex sends it there
// anew (kernels/lib/shift_photon.h); where that is too smooth to, specular or glossy, a manifold walk brings the chain of
// such vertices there. Who has no such shift counts for himself, where gather points are of different BSDF kinds, say
// (docs/design.md, 'Gradients of photons', lists them).
#pragma once

#include "methods/difference_film.h"
#include "methods/method.h"
#include "methods/photons/gather_paths.h"
#include "methods/photons/pass_photons.h"
#include "methods/photons/photon_pairs.h"
#include "methods/photons/radius_bias.h"
#include "runtime/wavefront/grouping.h"
#include "runtime/wavefront/manifold_walk.h"

#include <memory>
#include <optional>

namespace gradus {

/// Why the method cannot render a scene; empty where it can.
std::string reason_against_gpm(const Scene &scene);

class GradientPhotonMapper final : public Method {
  public:
    /// Throws Error(ExitCode::usage) as PhotonMapper does.
    GradientPhotonMapper(Device &device, const Scene &scene, const RenderOptions &options);

    std::uint64_t total_samples() const override { return total_; }
    std::uint64_t done_samples() const override { return done_; }
    std::uint64_t frame_samples() const override { return session_.pixels(); }
    bool render_batch() override;
    /// The channels of GradientPathTracer::image().
    Image image() override { return make_image(options_.layers, false); }
    Image last_image() override { return make_image(options_.layers, true); }
    Image mean_image() override { return film_.mean(done_); }
    Statistics statistics() const override;

    Tracer *tracer() override { return &session_.tracer; }

  private:
    /// Rows of the image that are rendered at once.
    struct Strip {
        std::uint32_t first = 0, rows = 0, pixels = 0;
    };
    void allocate();
    TableList tables() const;
    Strip next_strip() const;
    void begin_strip(const Strip &strip);
    void gather_photons(const Strip &strip);
    void shift_photons(std::size_t kind, const PairWindow &window);
    void move_chains(Range chains, std::uint32_t pairs);
    std::uint32_t light_bin() const;
    Image make_image(bool layers, bool last);
    bool has_chains() const { return !walked_kinds_.empty(); }

    RenderOptions options_;
    Session session_;
    Stages stages_;
    const std::vector<std::string> walked_kinds_; ///< BSDF kinds of surfaces whose vertices walks move
    GatherPaths paths_;
    PassPhotons photons_;
    PhotonPairs pairs_;
    Stage &bin_;
    Grouping order_; ///< of gather points, by BSDF kind
    Stage &evaluate_, &shift_;
    Grouping moved_; ///< photons, by the kind of their last vertex
    Stage &reconnect_, &reconnect_light_;
    Stage &project_, &walk_, &leave_, &leave_light_, &pass_, &end_; ///< photons at the end of chains
    std::optional<ManifoldWalk> manifold_walk_;
    Stage &count_;
    RadiusBias bias_;
    Stage &arrive_, &sum_, &gradient_gather_;
    DifferenceFilm film_;
    std::optional<Tables> tables_;

    std::uint64_t total_ = 0, done_ = 0;
    std::uint32_t strip_rows_ = 0;    ///< but for the last strip
    std::uint64_t moved_photons_ = 0; ///< those that it was tried with
    Statistics statistics_;
};

std::unique_ptr<Method> make_gradient_photon_mapper(Device &device, const Scene &scene, const RenderOptions &options);

} // namespace gradus
