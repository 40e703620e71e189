// The commands of the program, one file each. Each function adds its command to the command line; where the user
// names it, it sets `chosen` to what shall run, which returns the exit code and may throw.
#pragma once

#include "driver/services.h"

#include <functional>

namespace CLI {
class App;
}

namespace gradus {

void add_render_command(CLI::App &app, const Services &services, std::function<int()> &chosen);
void add_inspect_command(CLI::App &app, const Services &services, std::function<int()> &chosen);
void add_devices_command(CLI::App &app, const Services &services, std::function<int()> &chosen);
void add_plugins_command(CLI::App &app, std::function<int()> &chosen);
void add_compare_command(CLI::App &app, std::function<int()> &chosen);
void add_solve_command(CLI::App &app, const Services &services, std::function<int()> &chosen);
void add_tune_command(CLI::App &app, const Services &services, std::function<int()> &chosen);
void add_warm_command(CLI::App &app, const Services &services, std::function<int()> &chosen);

} // namespace gradus
