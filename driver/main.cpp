#include "driver/program.h"
#include "runtime/scene/traits.h"

int main(int argc, char **argv) {
    gradus::Services services;
    services.load_scene = gradus::load_scene;
    services.list_devices = gradus::list_devices;
    services.method_names = gradus::method_names;
    services.traits = gradus::trait_list;
    services.prepare = [](const std::string &method, const std::string &selector, const gradus::Scene &scene,
                          const gradus::RenderOptions &options) {
        const auto device = std::make_shared<gradus::Device>(selector, options.threads);
        return gradus::PreparedMethod{device, device->description(),
                                      gradus::make_method(method, *device, scene, options)};
    };
    return gradus::run_program(argc, argv, services);
}
