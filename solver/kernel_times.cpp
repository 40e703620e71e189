#include "solver/kernel_times.h"

#include "runtime/device/program.h"

#include <algorithm>

namespace gradus {

void add_time(std::vector<KernelTime> &times, const KernelTime &time) {
    const auto place =
        std::lower_bound(times.begin(), times.end(), time.name,
                         [](const KernelTime &other, const std::string &name) { return other.name < name; });
    if (place == times.end() || place->name != time.name) {
        times.insert(place, time);
        return;
    }
    place->seconds += time.seconds;
    place->launches += time.launches;
}

void add_times(std::vector<KernelTime> &times, const std::vector<Kernel *> &kernels) {
    for (Kernel *kernel : kernels) {
        const Kernel::Usage usage = kernel->usage();
        if (usage.launches > 0)
            add_time(times, {kernel->name(), usage.seconds, usage.launches});
    }
}

void reset_times(const std::vector<Kernel *> &kernels) {
    for (Kernel *kernel : kernels)
        kernel->reset_usage();
}

} // namespace gradus
