// What every rendering method offers to the driver. A method knows stages and tables; it never mentions OpenCL,
// Embree or OpenImageIO.
#pragma once

#include "runtime/device/precision.h"
#include "runtime/film/image.h"
#include "runtime/scene/scene.h"
#include "solver/poisson_solver.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gradus {

class Device; // runtime/device/device.h

struct RenderOptions {
    std::uint64_t seed = 0;
    int threads = 0;                         ///< host threads that trace; 0: all
    std::uint32_t batch_size = 0;            ///< paths in flight; 0: the device's default
    std::uint32_t work_group_size = 0;       ///< of the renderer's kernels; 0: the default
    Precision precision = Precision::single; ///< of the kernels; rays are always traced in float
    bool aov = false;                        ///< also albedo, normal, depth, variance
    bool layers = false;                     ///< also what the image was reconstructed from, gradient-domain methods
    bool all_traits = false; ///< for measuring: compile the kernels for everything, as if the scene had it
    enum class Strategy { mis, light, bsdf };
    Strategy strategy = Strategy::mis;  ///< for tests: light sampling alone or BSDF sampling alone
    PoissonNorm norm = PoissonNorm::l1; ///< of the reconstruction, gradient-domain methods
    std::optional<double> alpha;        ///< their weight of the primal; none: from the variances
    double shift_threshold = 0.01;      ///< offset paths reconnect at surfaces of this roughness (alpha) or more
    /// They do not over ways shorter than eight times the distance of base and offset vertex, or than this share of the
    /// scene's diameter if that is less (kernels/lib/reconnectable.h); 0: over any.
    double shift_distance = 0;
    std::string dump_kernels; ///< folder for the source of each kernel as it was compiled; empty: none
    /// Called when a kernel has been compiled: its name, how many are ready, of how many, and its seconds.
    std::function<void(const std::string &, std::size_t, std::size_t, double)> on_compiled;
    /// Called before the method `auto` renders a pilot, with its samples a pixel.
    std::function<void(std::uint64_t)> on_pilot;
};

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

/// What a render did. Written as JSON beside the image.
struct Statistics {
    struct Stage {
        std::string name;
        double seconds = 0;      ///< wall time
        std::uint64_t items = 0; ///< rows or rays it worked on
        std::uint64_t launches = 0;
    };
    std::vector<Stage> stages;                     ///< in the order in which a path meets them
    std::map<std::string, std::uint64_t> rays;     ///< by kind: "extension", "shadow"
    std::map<std::string, std::uint64_t> shifts;   ///< by what became of them, gradient-domain methods
    std::map<std::string, double> compile_seconds; ///< by kernel; empty where all came from a cache
    std::uint64_t samples = 0;                     ///< paths begun
    std::uint64_t non_finite = 0;                  ///< samples left out because they were NaN or infinite
    double render_seconds = 0;                     ///< spent in render_batch()
    std::uint64_t device_bytes = 0;                ///< allocated on the device
    std::uint64_t peak_host_bytes = 0;             ///< the process at its peak
    std::optional<MethodChoice> choice;            ///< of the method `auto`
};

class Method {
  public:
    virtual ~Method() = default;

    /// Samples (pixels times samples per pixel) that the whole render takes, and how many are done.
    virtual std::uint64_t total_samples() const = 0;
    virtual std::uint64_t done_samples() const = 0;
    /// Renders the next batch. Returns false once all samples are done. The image depends neither on the batch
    /// size nor on the number of threads.
    virtual bool render_batch() = 0;
    /// The image of the samples done so far: R, G, B and, with aov, albedo, normal, depth and variance layers; with
    /// layers, those that a reconstruction is made from. Each pixel is divided by its own count; a pixel without a
    /// sample is 0. Metadata is the driver's.
    virtual Image image() = 0;
    /// The same for the last time: the method may let go of the memory that it renders to. Only statistics() may be
    /// called after it.
    virtual Image last_image() { return image(); }
    virtual Statistics statistics() const = 0;
};

/// Methods by their names on the command line; `auto` picks one of the others.
std::vector<std::string> method_names();
/// Prepares a render: builds the kernels, lays out the scene, allocates the batch. Throws Error.
std::unique_ptr<Method> make_method(const std::string &name, Device &device, const Scene &scene,
                                    const RenderOptions &options);

} // namespace gradus
