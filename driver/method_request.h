// How to render, as the command line asks for it: method, device, threads.
#pragma once

#include "driver/services.h"

#include <string>

namespace CLI {
class App;
}

namespace gradus {

struct MethodRequest {
    std::string method = "gpt";
    std::string device; ///< Device's selector
    RenderOptions options;
    bool guide_is_given = false;
};

/// Adds the options that fill `request` to a command.
void add_method_options(CLI::App &command, const Services &services, MethodRequest &request);

} // namespace gradus
