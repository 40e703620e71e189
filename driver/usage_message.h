// What is said of a command line that cannot be read.
#pragma once

#include <string>

namespace CLI {
class App;
class Error;
} // namespace CLI

namespace gradus {

/// The error's own words; of commands and options that do not exist, which ones and what may have been meant, or which
/// commands have the option.
std::string usage_message(const CLI::App *app, const CLI::Error &error);

} // namespace gradus
