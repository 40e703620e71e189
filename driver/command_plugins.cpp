#include "driver/commands.h"
#include "driver/plugin_tables.h"
#include "driver/standard_streams.h"
#include "runtime/error.h"
#include "runtime/io/text.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>

namespace gradus {
namespace {

int run_plugins(const std::vector<std::string> &names) {
    std::vector<std::string> known;
    for (const CataloguedPlugin &plugin : plugin_catalogue())
        known.push_back(plugin.name);
    for (const std::string &name : names)
        if (std::ranges::count(known, name) == 0) {
            const auto nearest = nearest_name(name, known);
            throw Error(ExitCode::usage, "no plugin is named \"" + name + "\"" +
                                             (nearest ? "; did you mean \"" + *nearest + "\"?" : ""));
        }
    print_result(plugin_tables(plugin_catalogue(), names));
    return static_cast<int>(ExitCode::success);
}

} // namespace

void add_plugins_command(CLI::App &app, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("plugins", "List the plugins of scene files with their parameters");
    const auto names = std::make_shared<std::vector<std::string>>();
    command.add_option("NAME", *names, "Only plugins of these names");
    command.footer("Examples:\n"
                   "  gradus plugins                 all of them\n"
                   "  gradus plugins dielectric obj  what these take, and in which dialects");
    command.callback([names, &chosen] { chosen = [names] { return run_plugins(*names); }; });
}

} // namespace gradus
