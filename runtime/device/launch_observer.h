// Watching what is launched on a device: for measuring the kernels of a render on the very tables that it gives them.
#pragma once

#include "runtime/device/program.h"

#include <functional>
#include <map>
#include <string>
#include <variant>

namespace gradus {

/// A launch that is about to happen, with all that it takes to repeat it or to build its kernel otherwise.
struct Launch {
    struct Argument {
        std::string type; ///< as the source has it: "uint", "real", "uint*", "real*"
        std::variant<std::uint32_t, double, Buffer> value;
    };
    const KernelRequest &request;
    const TraitValues &traits;
    const std::map<std::string, Argument> &arguments; ///< by name
    std::size_t items;
    std::size_t lines;  ///< of so many items each; 0: Kernel::launch(items) makes them
    std::size_t planes; ///< of Kernel::launch_planes(); else 1
};

using LaunchObserver = std::function<void(const Launch &)>;

/// Has `observer` called before each launch of every kernel that is built for the device from now on. An empty one ends
/// it. What the observer itself builds and launches is not observed.
void observe_launches(Device &device, LaunchObserver observer);

} // namespace gradus
