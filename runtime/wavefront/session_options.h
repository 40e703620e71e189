// What the caller asks of a render beside what the scene file says, whatever the method.
#pragma once

#include "runtime/device/precision.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace gradus {

class Phases;

/// Thrown where SessionOptions::stop has asked for it. The samples of that batch are lost, those before are not; only
/// an image may be asked for then.
struct Stopped {};

struct SessionOptions {
    std::uint64_t seed = 0;
    int threads = 0;                         ///< host threads that trace; 0: all
    std::uint32_t batch_size = 0;            ///< paths in flight; 0: the device's default
    std::uint32_t work_group_size = 0;       ///< of the renderer's kernels; 0: the default
    Precision precision = Precision::single; ///< of the kernels; rays are always traced in float
    bool aov = false;                        ///< also albedo, normal, depth and, with `variance`, variances
    bool variance = true;                    ///< for which the samples of a sequence are taken apart (sample_parts.h)
    bool all_traits = false; ///< for measuring: compile the kernels for everything, as if the scene had it
    bool by_index = false;   ///< for tests: triangles by index, however few
    /// How the samples of a pixel draw: each by itself, or together from a Sobol sequence, scrambled by pixel and
    /// dimension (kernels/lib/stratified.h). Light paths of photons are independent in either case.
    enum class Sampler { sobol, independent };
    Sampler sampler = Sampler::sobol;
    /// How light samples choose a light: by power, or from a tree by what may arrive; automatic: from a tree where
    /// there are many.
    enum class Lights { automatic, tree, power };
    Lights lights = Lights::automatic;
    enum class Strategy { mis, light, bsdf };
    Strategy strategy = Strategy::mis; ///< for tests: light sampling alone or BSDF sampling alone
    std::string dump_kernels;          ///< folder for the source of each kernel as it was compiled; empty: none
    Phases *phases = nullptr;          ///< where the time until the first sample is counted; may be nullptr
    /// Asked every few milliseconds while samples render; true: render_batch() throws Stopped. May be empty.
    std::function<bool()> stop;
    /// Called when a kernel has been compiled: its name, how many are ready, of how many, and its seconds.
    std::function<void(const std::string &, std::size_t, std::size_t, double)> on_compiled;
};

} // namespace gradus
