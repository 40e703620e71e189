#include "driver/commands.h"
#include "driver/output_files.h"
#include "driver/standard_streams.h"
#include "driver/tuning_store.h"
#include "runtime/error.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace gradus {
namespace {

constexpr const char *advice =
    "No OpenCL device was found. For the processor install PoCL, on Debian with\n"
    "  apt install pocl-opencl-icd\n"
    "and for a graphics card the OpenCL driver of its maker. The folder /etc/OpenCL/vendors, or the one that\n"
    "OCL_ICD_VENDORS names, must hold an .icd file for each. PoCL needs a folder that it may write to: where neither\n"
    "the home folder nor /tmp is one, POCL_CACHE_DIR names another.\n";

std::string tuning_text(const DeviceDescription &device) {
    std::string problem;
    const std::optional<Tuning> tuning = stored_tuning(device, &problem);
    if (!problem.empty())
        return "no: " + problem;
    return tuning ? name_of(*tuning) : "no";
}

nlohmann::json tuning_json(const DeviceDescription &device) {
    const std::optional<Tuning> tuning = stored_tuning(device);
    if (!tuning)
        return nullptr;
    return {{"work_group_size", tuning->work_group_size}, {"batch_size", tuning->batch_size}};
}

std::string device_table(const std::vector<DeviceDescription> &devices) {
    std::string text;
    for (std::size_t i = 0; i < devices.size(); ++i) {
        const DeviceDescription &device = devices[i];
        text += fmt::format("{}  {}\n", i, device.name);
        text += fmt::format("   platform     {}\n", device.platform);
        text += fmt::format("   type         {}, {} compute units\n", device.type, device.compute_units);
        text += fmt::format("   version      {}, driver {}\n", device.version, device.driver);
        text += fmt::format("   memory       {:.1f} GiB, {:.1f} GiB in one piece, as it reports\n",
                            double(device.memory_bytes) / double(1 << 30),
                            double(device.allocation_bytes) / double(1 << 30));
        text += fmt::format("   double       {}\n", device.has_double ? "yes" : "no");
        text += fmt::format("   tuned        {}\n", tuning_text(device));
    }
    return text;
}

std::string device_json(const std::vector<DeviceDescription> &devices) {
    nlohmann::json list = nlohmann::json::array();
    for (const DeviceDescription &device : devices)
        list.push_back({{"name", device.name},
                        {"platform", device.platform},
                        {"vendor", device.vendor},
                        {"version", device.version},
                        {"driver", device.driver},
                        {"type", device.type},
                        {"compute_units", device.compute_units},
                        {"memory_bytes", device.memory_bytes},
                        {"allocation_bytes", device.allocation_bytes},
                        {"double", device.has_double},
                        {"tuning", tuning_json(device)}});
    return json_text(list);
}

} // namespace

void add_devices_command(CLI::App &app, const Services &services, std::function<int()> &chosen) {
    CLI::App &command = *app.add_subcommand("devices", "List the OpenCL devices; exit code 4 where there is none");
    const auto as_json = std::make_shared<bool>(false);
    command.footer("`--device` of other commands takes a number of this list or a part of a name.");
    command.add_flag("--json", *as_json, "Print JSON");
    command.callback([as_json, &services, &chosen] {
        chosen = [as_json, &services] {
            const std::vector<DeviceDescription> devices = services.list_devices();
            print_result(*as_json ? device_json(devices) : device_table(devices));
            if (devices.empty())
                print_message(advice);
            return static_cast<int>(devices.empty() ? ExitCode::device : ExitCode::success);
        };
    });
}

} // namespace gradus
