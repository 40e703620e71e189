#include "planning/make_method.h"

#include "runtime/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

/// METHOD(name on the command line, function that makes it). A new method is its file in methods/, which defines that
/// function, and a line here.
#define GRADUS_METHODS(METHOD)                                                                                         \
    METHOD("pt", make_path_tracer)                                                                                     \
    METHOD("gpt", make_gradient_path_tracer)                                                                           \
    METHOD("sppm", make_photon_mapper)                                                                                 \
    METHOD("gpm", make_gradient_photon_mapper)                                                                         \
    METHOD("auto", make_automatic_method)

namespace gradus {

#define GRADUS_METHOD_DECLARATION(name, function)                                                                      \
    std::unique_ptr<Method> function(Device &, const Scene &, const RenderOptions &);
GRADUS_METHODS(GRADUS_METHOD_DECLARATION)
#undef GRADUS_METHOD_DECLARATION

std::vector<std::string> method_names() {
#define GRADUS_METHOD_NAME(name, function) name,
    return {GRADUS_METHODS(GRADUS_METHOD_NAME)};
#undef GRADUS_METHOD_NAME
}

std::unique_ptr<Method> make_method(const std::string &name, Device &device, const Scene &scene,
                                    const RenderOptions &options) {
    if (options.only_chains && name != "gpm")
        throw Error(ExitCode::usage, "--only-chains is of gpm");
#define GRADUS_METHOD_OF_NAME(method, function)                                                                        \
    if (name == method)                                                                                                \
        return function(device, scene, options);
    GRADUS_METHODS(GRADUS_METHOD_OF_NAME)
#undef GRADUS_METHOD_OF_NAME
    throw Error(ExitCode::usage,
                fmt::format("there is no method \"{}\"; there is: {}", name, fmt::join(method_names(), ", ")));
}

} // namespace gradus
