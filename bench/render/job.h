// A scene with the settings that it is measured at, and one render of it.
#pragma once

#include "bench/spread.h"
#include "methods/path_tracer.h"
#include "runtime/device/device.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace gradus::bench {

struct Job {
    std::string name;
    Scene scene;
};

/// What all measurements share.
struct Settings {
    Device &device;
    int threads = 0;
    int repeats = 5;
    std::string method = "pt";
};

/// The file at this size and number of samples. `roulette` false: max depth 13 without Russian roulette, as against
/// other renderers; true: as the file has it.
Job load_job(const std::string &path, std::uint32_t width, std::uint32_t height, std::uint64_t samples_per_pixel,
             bool roulette);

struct Render {
    Statistics statistics;
    Image image;

    std::uint64_t rays() const;
    double seconds() const { return statistics.render_seconds; }
    /// Of all kernels together.
    double kernel_seconds() const;
    /// Of one row of the profile; 0 where there is none.
    double stage_seconds(const std::string &name) const;
};

/// The method of the settings.
std::unique_ptr<Method> method_of(const Settings &settings, const Job &job, const RenderOptions &options);

/// Renders all samples. `prepare` is called before the first batch. Throws Error where a sample was not finite: such
/// a render is no measurement.
Render render(const Settings &settings, const Job &job, const RenderOptions &options = {},
              const std::function<void(Method &)> &prepare = {});

} // namespace gradus::bench
