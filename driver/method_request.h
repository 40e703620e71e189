// How to render, as the command line asks for it: method, device, threads.
#pragma once

#include "driver/services.h"

#include <set>
#include <string>

namespace CLI {
class App;
}

namespace gradus {

struct MethodRequest {
    std::string method = "gpt";
    std::string device; ///< Device's selector
    RenderOptions options;
    std::set<std::string> given; ///< long names of the command's options that were given: "--alpha"
};

/// Adds the options that fill `request` to a command.
void add_method_options(CLI::App &command, const Services &services, MethodRequest &request);

/// MethodRequest::given, of a command that has been parsed.
std::set<std::string> given_options(const CLI::App &command);

} // namespace gradus
