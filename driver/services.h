// What the program asks of the runtime, as functions, so that tests can run the program with a method of their own.
#pragma once

#include "methods/method.h"
#include "planning/tuner.h"
#include "runtime/device/device.h"
#include "runtime/io/load_scene.h"
#include "solver/guide/guided_reconstruction.h"
#include "solver/poisson_solver.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gradus {

/// A method that is ready to render, and the device that it renders on.
struct PreparedMethod {
    std::shared_ptr<void> device; ///< outlives the method
    DeviceDescription description;
    std::unique_ptr<Method> method;
    std::string warning{}; ///< empty: none
};

/// A Poisson solver for images of one size, and the device that it runs on.
struct PreparedSolver {
    std::shared_ptr<void> device; ///< outlives the solver
    DeviceDescription description;
    std::function<PoissonReport(const HostImages &, const PoissonOptions &, float *result)> solve;
    std::function<PoissonReport(const HostHalves &, float *result)> solve_weighted;
    std::function<PoissonReport(const HostHalves &, const HostGuideInputs &, Guide, float *result)> solve_guided;
};

/// What a tuner found, and for which device.
struct TunedDevice {
    DeviceDescription description;
    TuningReport report;
};

struct Services {
    std::function<LoadedScene(const std::string &path, const LoadOptions &)> load_scene;
    std::function<std::vector<DeviceDescription>()> list_devices;
    std::function<std::vector<std::string>()> method_names;
    /// Opens the device (Device's selector) and prepares the method on it.
    std::function<PreparedMethod(const std::string &method, const std::string &device, const Scene &,
                                 const RenderOptions &)>
        prepare;
    /// Opens the device and makes a solver for images of that size on it.
    std::function<PreparedSolver(const std::string &device, int threads, std::uint32_t width, std::uint32_t height,
                                 std::uint32_t channels)>
        prepare_solver;
    /// Opens the device and tunes it with the scene.
    std::function<TunedDevice(const std::string &device, int threads, const Scene &, const TuningOptions &)> tune;
    /// Where compiled kernels are kept; empty where they are not.
    std::function<std::filesystem::path()> cache_folder;
    /// How many of them could not be kept there so far.
    std::function<std::uint64_t()> programs_not_kept;
    /// The traits that specialise the kernels of a scene, by name.
    std::function<std::vector<std::pair<std::string, int>>(const Scene &)> traits;
};

} // namespace gradus
