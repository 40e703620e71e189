// What a render did, and what it took.
#pragma once

#include "runtime/scene/roughness.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

/// Which method `auto` picked, and why.
struct MethodChoice {
    std::string method;
    std::string reason;              ///< a sentence
    std::uint64_t pilot_samples = 0; ///< a pixel, of the pilot render; 0: there was none
    double pilot_seconds = 0;        ///< kernels compiled
    struct Estimate {
        double relative_mse = 0; ///< of an image of one sample a pixel; falls with the number of samples
        double cost = 0;         ///< of a sample, in rays; counted, so that it is the same on each run
    };
    std::map<std::string, Estimate> estimates; ///< by method; empty without a pilot
    double gain = 0;                           ///< relMSE of pt over gpt's at equal cost; 0 where it is not known
};

/// How an image was made of its samples.
struct ReconstructionUsed {
    std::string name;              ///< "l1", "weighted"; "none": the mean of the samples
    std::string accuracy;          ///< "unbiased", "consistent" or "neither"
    std::string note;              ///< a sentence where it is not the one that was asked for, else empty
    std::string guide{};           ///< of "guided": "filter" or "denoiser"; else empty
    std::optional<double> alpha{}; ///< of "l1" and "l2": the weight of the primal
};

/// What a stage took.
struct StageTime {
    std::string name;
    double seconds = 0;      ///< wall time
    std::uint64_t items = 0; ///< rows or rays it worked on
    std::uint64_t launches = 0;
};

/// Radii that photons are gathered from.
struct GatherRadii {
    std::uint64_t points = 0; ///< gather points
    double sum = 0;           ///< of theirs, world units
};

/// What a render did. Written as JSON beside the image.
struct Statistics {
    std::vector<StageTime> stages;                 ///< in the order in which a path meets them
    std::map<std::string, std::uint64_t> rays;     ///< by kind: "extension", "shadow"
    std::map<std::string, std::uint64_t> shifts;   ///< by what became of them, gradient-domain methods
    std::map<std::string, std::uint64_t> walks;    ///< by what became of them, methods with manifold walks
    std::map<std::string, double> compile_seconds; ///< by kernel; empty where all came from a cache
    std::uint64_t samples = 0;                     ///< paths begun
    std::uint64_t light_paths = 0;                 ///< begun, methods that trace them
    std::uint64_t photons = 0;                     ///< that these left
    std::uint64_t gather_points = 0;               ///< where camera paths looked for photons
    std::uint64_t photon_pairs = 0;                ///< of gather points and photons within their radius
    double radius_sum = 0;                         ///< of all gather points, world units
    GatherRadii first_radii, last_radii;           ///< of the first pass and the last one begun
    std::optional<double> relative_variance;       ///< of the image, from the spread of its passes, where it is known
    std::optional<double> relative_squared_bias;   ///< by the radii of photons, where it is known
    GatheringSurfaces surfaces;                    ///< where photons are gathered and where not, photon methods
    std::uint64_t non_finite = 0;                  ///< samples left out because they were NaN or infinite
    std::uint64_t lost_pixels = 0;                 ///< whose mean is no finite number: a reconstruction has filled them
    double render_seconds = 0;                     ///< spent in render_batch()
    std::uint64_t device_bytes = 0;                ///< allocated on the device
    std::uint64_t peak_host_bytes = 0;             ///< the process at its peak
    std::optional<double> estimated_error;         ///< relMSE of the last image, as its halves tell, where asked for
    std::optional<MethodChoice> choice;            ///< of the method `auto`
    ReconstructionUsed reconstruction;             ///< of the last image
};

} // namespace gradus
