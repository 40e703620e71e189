#include "planning/make_method.h"

#include "methods/gradient_path_tracer.h"
#include "methods/path_tracer.h"
#include "planning/automatic_method.h"
#include "runtime/error.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace gradus {

std::vector<std::string> method_names() { return {"pt", "gpt", "auto"}; }

std::unique_ptr<Method> make_method(const std::string &name, Device &device, const Scene &scene,
                                    const RenderOptions &options) {
    if (name == "pt")
        return std::make_unique<PathTracer>(device, scene, options);
    if (name == "gpt")
        return std::make_unique<GradientPathTracer>(device, scene, options);
    if (name == "auto")
        return make_automatic_method(device, scene, options);
    throw Error(ExitCode::usage,
                fmt::format("there is no method \"{}\"; there is: {}", name, fmt::join(method_names(), ", ")));
}

} // namespace gradus
