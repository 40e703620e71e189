// Methods by name.
#pragma once

#include "methods/method.h"

#include <memory>
#include <string>
#include <vector>

namespace gradus {

/// Methods by their names on the command line; `auto` picks one of the others.
std::vector<std::string> method_names();
/// Prepares a render: builds the kernels, lays out the scene, allocates the batch. Throws Error.
std::unique_ptr<Method> make_method(const std::string &name, Device &device, const Scene &scene,
                                    const RenderOptions &options);

} // namespace gradus
