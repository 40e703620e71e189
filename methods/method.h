// What every rendering method offers to the driver. A method knows stages and tables; it never mentions OpenCL,
// Embree or OpenImageIO.
#pragma once

#include "runtime/film/image.h"
#include "runtime/scene/scene.h"
#include "runtime/wavefront/session_options.h"
#include "runtime/wavefront/statistics.h"
#include "solver/reconstruction.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

class Device; // runtime/device/device.h
class Tracer; // runtime/trace/tracer.h

/// What methods that reconstruct ask beside that.
struct RenderOptions : SessionOptions {
    bool layers = false; ///< also what the image was reconstructed from, gradient-domain methods
    /// The error of the image is estimated: samples are kept as two halves, with random numbers of their own.
    bool error = false;
    Reconstruction reconstruction = Reconstruction::weighted; ///< gradient-domain methods
    Guide guide = Guide::filter;                              ///< of Reconstruction::guided
    /// Of l1 and l2, the weight of the primal; none: from the variances.
    std::optional<double> alpha;
    double shift_threshold = 0.01; ///< offset paths reconnect at surfaces of this roughness (alpha) or more
    /// They do not over ways shorter than eight times the distance of base and offset vertex, or than this share of the
    /// scene's diameter if that is less (kernels/lib/reconnectable.h); 0: over any.
    double shift_distance = 0;
    std::uint64_t photons = 0; ///< light paths a pass, photon methods; 0: as many as leave about five photons a pixel
    double gather_roughness = 0.05; ///< photons are kept, and gathered, at surfaces of this roughness (alpha) or more
    bool direct_photons = false;    ///< lights' direct light at gather points by photons too, not by sampling lights
    /// Photons are gathered in the first pass from so far: in widths of a pixel at the gather point or, if it is
    /// `of_scene`, as a share of the scene's diameter.
    struct GatherRadius {
        double value = 1;
        bool of_scene = false;
    };
    /// None: sppm's 2 widths, of which each photon's light is spread over many pixels, and gpm's 0.5, about a pixel:
    /// there the reconstruction does so, and by the image.
    std::optional<GatherRadius> radius;
    bool bias_layer = false; ///< the layer `bias` (radius_bias.h) without the others of `aov`, photon methods
    /// To measure shifts of chains alone, gpm: no light but by photons whose light path was, at the vertex before, on a
    /// surface too smooth to gather at.
    bool only_chains = false;
    double radius_alpha = 0.9; ///< how slowly the radius shrinks, in (0, 1]; 1: not at all
    /// Seconds that the render ends after; 0: it does not. The pilots of the method `auto` are small beside them.
    double time_limit = 0;
    /// Called before the method `auto` renders a pilot, with its samples a pixel.
    std::function<void(std::uint64_t)> on_pilot;
};

/// Whether albedo, normal and depth are kept: to be written, or for a guide.
inline bool needs_features(const RenderOptions &options) {
    return options.aov || options.reconstruction == Reconstruction::guided;
}

/// Whether gradient-domain methods keep samples as two halves.
inline bool keeps_halves(const RenderOptions &options) { return options.error || needs_halves(options.reconstruction); }

class Method {
  public:
    virtual ~Method() = default;

    /// Samples that the whole render takes, and how many are done; those of one frame: one for each pixel, and for each
    /// around the image that the pixel filter reaches.
    virtual std::uint64_t total_samples() const = 0;
    virtual std::uint64_t done_samples() const = 0;
    virtual std::uint64_t frame_samples() const = 0;
    /// Renders the next batch. Returns false once all samples are done. The image depends neither on the batch
    /// size nor on the number of threads.
    virtual bool render_batch() = 0;
    /// The batch that reaches so many samples ends there, so that an image may be asked for.
    virtual void pause_at(std::uint64_t samples) { pause_ = samples; }
    /// The image of the samples done so far: R, G, B and, with aov, albedo, normal, depth and variance layers; with
    /// layers, those that a reconstruction is made from. Each pixel is divided by its own count; a pixel without a
    /// sample is 0. Metadata is the driver's.
    virtual Image image() = 0;
    /// The same for the last time: the method may let go of the memory that it renders to. Only statistics() may be
    /// called after it, and mean_image() where it throws.
    virtual Image last_image() { return image(); }
    /// The mean of the samples alone, R, G and B: where their reconstruction failed, also after last_image() has
    /// thrown.
    virtual Image mean_image() { return image(); }
    virtual Statistics statistics() const = 0;
    /// For measuring: records and replays the rays of a render. Null where there is none.
    virtual Tracer *tracer() { return nullptr; }

  protected:
    /// Samples to the end of the next batch at most.
    std::uint64_t samples_ahead() const {
        const std::uint64_t done = done_samples(), total = total_samples();
        return (done < pause_ ? std::min(pause_, total) : total) - done;
    }

  private:
    std::uint64_t pause_ = 0;
};

} // namespace gradus
