#include "driver/interrupt.h"
#include "driver/program.h"
#include "driver/solve_job.h"
#include "driver/standard_streams.h"
#include "driver/tuning_store.h"
#include "planning/make_method.h"
#include "runtime/device/cache_folder.h"
#include "runtime/device/program_store.h"
#include "runtime/phases.h"
#include "runtime/scene/traits.h"
#include "solver/weighted_reconstruction.h"

namespace {

std::shared_ptr<gradus::Device> open_device(const std::string &selector, int threads) {
    auto device = std::make_shared<gradus::Device>(selector, threads);
    gradus::ignore_what_was_ignored(); // which loading an OpenCL implementation may have changed
    return device;
}

} // namespace

int main(int argc, char **argv) {
    gradus::Services services;
    services.load_scene = gradus::load_scene;
    services.list_devices = gradus::list_devices;
    services.method_names = gradus::method_names;
    services.cache_folder = gradus::program_cache_folder;
    services.programs_not_kept = gradus::programs_not_kept;
    services.traits = gradus::trait_list;
    services.prepare = [](const std::string &method, const std::string &selector, const gradus::Scene &scene,
                          const gradus::RenderOptions &options) {
        const auto device = gradus::in_phase(options.phases, gradus::phase_names::device,
                                             [&] { return open_device(selector, options.threads); });
        gradus::RenderOptions tuned = options;
        std::string problem;
        gradus::apply_tuning(gradus::stored_tuning(device->description(), &problem), tuned);
        return gradus::PreparedMethod{device, device->description(), gradus::make_method(method, *device, scene, tuned),
                                      problem};
    };
    services.tune = [](const std::string &selector, int threads, const gradus::Scene &scene,
                       const gradus::TuningOptions &options) {
        const auto device = open_device(selector, threads);
        return gradus::TunedDevice{device->description(), gradus::tune(*device, "pt", scene, options)};
    };
    services.prepare_solver = [](const std::string &selector, int threads, std::uint32_t width, std::uint32_t height,
                                 std::uint32_t channels) {
        const auto device = open_device(selector, threads);
        gradus::check_images_fit(device->description(), width, height, channels);
        const auto solver = std::make_shared<gradus::PoissonSolver>(*device, width, height, channels);
        gradus::PreparedSolver prepared;
        prepared.device = device;
        prepared.description = device->description();
        prepared.solve = [solver](const gradus::HostImages &images, const gradus::PoissonOptions &options,
                                  float *result) { return solver->solve(images, options, result); };
        prepared.solve_weighted = [device, solver](const gradus::HostHalves &halves, float *result) {
            return gradus::solve_weighted(*device, *solver, halves, result);
        };
        prepared.solve_guided = [device, solver, threads](const gradus::HostHalves &halves,
                                                          const gradus::HostGuideInputs &inputs, gradus::Guide guide,
                                                          float *result) {
            return gradus::solve_guided(*device, *solver, halves, inputs, guide, threads, result);
        };
        return prepared;
    };
    return gradus::run_program(argc, argv, services);
}
