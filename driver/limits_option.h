// --limits, of all commands that read files.
#pragma once

#include <cstdint>

namespace CLI {
class App;
}

namespace gradus {

/// Adds --limits: files may take so many times what is read of them otherwise.
void add_limits_option(CLI::App &command, std::uint64_t &limits, const char *group);

} // namespace gradus
