// The photons of a pass, and the radius that they are gathered from.
#pragma once

#include "methods/method.h"
#include "methods/photons/light_paths.h"
#include "methods/photons/photon_map.h"

#include <cstdint>

namespace gradus {

/// The square of the radius of pass `pass`, from 0 on, over that of the first: Knaus and Zwicker 2011, eq. 20.
double radius_shrinkage(std::uint64_t pass, double alpha);

/// Of an image of photons (solver/reconstruction.h): right in the limit where radii shrink.
const char *accuracy_of_photons(const RenderOptions &options);

/// Counts gather points of pass `pass` and the sum of their radii. `begins`: they are the first of their pass.
void count_radii(Statistics &statistics, std::uint64_t pass, bool begins, const GatherRadii &radii);

/// Whether some surfaces are too smooth to gather at.
bool has_smooth_surface(const Scene &scene, const RenderOptions &options);

/// The scene itself. Throws Error(ExitCode::usage) where options or scene leave nothing to be gathered.
const Scene &checked_for_gathering(const Scene &scene, const RenderOptions &options);

class PassPhotons {
  public:
    /// pixel_widths: the radius where the options say none. `halves`: each half of the passes has radii of its own.
    /// Throws Error(ExitCode::usage) where there is no light. Sets the reals that `gather` reads (`radius_slope`...)
    /// and `flux_scale`.
    PassPhotons(Session &session, Stages &stages, const Scene &scene, const RenderOptions &options, double pixel_widths,
                bool halves);

    TableList tables() const;
    /// To be called once these are allocated and before the stages are built,
    void attach(Tables &tables);

    /// Traces and sorts the photons of a pass, unless they are there.
    void begin(std::uint64_t pass);

    const LightPaths &light_paths() const { return light_paths_; }

  private:
    void set_radius(Session &session, RenderOptions::GatherRadius radius);

    const RenderOptions options_;
    const bool has_halves_;
    Stages &stages_;
    LightPaths light_paths_;
    PhotonMap map_;
    std::uint32_t paths_a_pass_ = 0; ///< light paths
    std::uint64_t pass_ = ~0ull;
    /// Of gather points in the first pass, as far as the camera tells, world units: their radius, the least edge of
    /// cells for them, and the area that all photons are spread over.
    double median_radius_ = 0, least_edge_ = 0, seen_area_ = 0;
};

} // namespace gradus
