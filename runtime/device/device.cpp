#include "runtime/device/device.h"

#include "runtime/device/cache_folder.h"
#include "runtime/device/compile_workers.h"
#include "runtime/device/opencl.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <thread>

namespace gradus {

namespace {

std::string trimmed(std::string text) {
    while (!text.empty() && (text.back() == '\0' || text.back() == ' '))
        text.pop_back();
    return text;
}

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
    return text;
}

/// Not all implementations answer what OpenCL 2.0 made deprecated, without another question in its place.
bool has_memory_of_host(const cl::Device &device) {
    try {
        return device.getInfo<CL_DEVICE_HOST_UNIFIED_MEMORY>() == CL_TRUE;
    } catch (const cl::Error &) {
        return false;
    }
}

DeviceDescription describe(const cl::Platform &platform, const cl::Device &device) {
    DeviceDescription d;
    d.platform = trimmed(platform.getInfo<CL_PLATFORM_NAME>());
    d.platform_version = trimmed(platform.getInfo<CL_PLATFORM_VERSION>());
    d.name = trimmed(device.getInfo<CL_DEVICE_NAME>());
    d.vendor = trimmed(device.getInfo<CL_DEVICE_VENDOR>());
    d.version = trimmed(device.getInfo<CL_DEVICE_VERSION>());
    d.driver = trimmed(device.getInfo<CL_DRIVER_VERSION>());
    const cl_device_type type = device.getInfo<CL_DEVICE_TYPE>();
    d.type = type & CL_DEVICE_TYPE_CPU ? "cpu" : type & CL_DEVICE_TYPE_GPU ? "gpu" : "accelerator";
    d.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
    d.memory_bytes = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
    d.local_bytes = device.getInfo<CL_DEVICE_LOCAL_MEM_SIZE>();
    d.allocation_bytes = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
    d.is_host = (type & CL_DEVICE_TYPE_CPU) != 0;
    d.shares_memory = d.is_host || has_memory_of_host(device);
    d.has_double = device.getInfo<CL_DEVICE_EXTENSIONS>().find("cl_khr_fp64") != std::string::npos;
    return d;
}

std::string list_of(const std::vector<DeviceDescription> &found) {
    std::string text;
    for (std::size_t i = 0; i < found.size(); ++i)
        text += fmt::format("\n  {}: {} ({})", i, found[i].name, found[i].platform);
    return text;
}

} // namespace

std::size_t chosen_device(const std::vector<DeviceDescription> &found, const std::string &selector) {
    if (found.empty())
        throw Error(ExitCode::device,
                    "no OpenCL device was found; install one, for example PoCL for the CPU: "
                    "apt install pocl-opencl-icd, and POCL_CACHE_DIR, where it can write nowhere else");
    if (selector.empty()) {
        for (std::size_t i = 0; i < found.size(); ++i)
            if (is_pocl_cpu(found[i]))
                return i;
        return 0;
    }
    const bool is_number =
        std::all_of(selector.begin(), selector.end(), [](unsigned char c) { return std::isdigit(c); });
    if (is_number) {
        const unsigned long number = selector.size() < 6 ? std::stoul(selector) : found.size();
        if (number < found.size())
            return number;
    }
    // Longer numbers are parts of names ("3060"); so short ones are in most of them.
    constexpr std::size_t longest_number = 2;
    const bool may_be_name = !is_number || selector.size() > longest_number;
    for (std::size_t i = 0; may_be_name && i < found.size(); ++i)
        if (lower(found[i].platform + " " + found[i].name).find(lower(selector)) != std::string::npos)
            return i;
    throw Error(ExitCode::device,
                fmt::format("no OpenCL device matches \"{}\"; there are:{}", selector, list_of(found)));
}

namespace {

/// PoCL unpacks programs that it gets as code into its folder. Processes that share one can disturb each other (pocl
/// #430), so each has one of its own, which need not be on a disk. A folder that the user chose stays.
void give_pocl_a_private_folder() {
    if (std::getenv("POCL_CACHE_DIR") || program_cache_folder().empty() || compile_worker_program().empty())
        return;
    if (const std::filesystem::path folder = private_folder(); !folder.empty())
        setenv("POCL_CACHE_DIR", (folder / "pocl").c_str(), 0);
}

} // namespace

std::vector<FoundDevice> find_devices(int threads) {
    // Neither variables nor PoCL 3.1, which begins at the first call, are safe for several threads.
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    // PoCL reads its variables once, when the platform is first asked for.
    give_pocl_a_private_folder();
    for (const char *variable : pocl_thread_variables)
        if (threads > 0)
            setenv(variable, std::to_string(threads).c_str(), 1);
    std::vector<FoundDevice> found;
    std::vector<cl::Platform> platforms;
    try {
        cl::Platform::get(&platforms);
    } catch (const cl::Error &) {
        return found; // the loader reports "no platform" as an error
    }
    for (const cl::Platform &platform : platforms) {
        std::vector<cl::Device> devices;
        try {
            platform.getDevices(CL_DEVICE_TYPE_ALL, &devices);
        } catch (const cl::Error &) {
            continue; // a platform without a device says so by an error
        }
        for (const cl::Device &device : devices)
            try {
                found.push_back({device, describe(platform, device)});
            } catch (const cl::Error &) {
                // One that does not say what it is cannot be used; those after it can.
            }
    }
    return found;
}

bool is_pocl_cpu(const DeviceDescription &d) {
    return d.type == "cpu" && lower(d.platform).find("portable computing language") != std::string::npos;
}

bool is_pocl_3_1_cpu(const DeviceDescription &d) { return is_pocl_cpu(d) && d.driver.starts_with("3.1"); }

bool is_pocl_5_or_6_cpu(const DeviceDescription &d) {
    return is_pocl_cpu(d) && (d.driver.starts_with("5.") || d.driver.starts_with("6."));
}

bool is_oclgrind(const DeviceDescription &d) { return d.platform == "Oclgrind"; }

namespace {

std::vector<DeviceDescription> descriptions_of(const std::vector<FoundDevice> &found) {
    std::vector<DeviceDescription> descriptions;
    for (const FoundDevice &one : found)
        descriptions.push_back(one.description);
    return descriptions;
}

} // namespace

std::vector<DeviceDescription> list_devices() { return descriptions_of(find_devices()); }

Device::Device(const std::string &selector, int threads) : implementation_(std::make_unique<Implementation>()) {
    const std::vector<FoundDevice> found = find_devices(threads);
    const FoundDevice &chosen = found[chosen_device(descriptions_of(found), selector)];
    implementation_->description = chosen.description;
    implementation_->device = chosen.device;
    implementation_->store = ProgramStore(program_cache_folder());
    // The compiler of Oclgrind 21.10 is not safe for several threads.
    implementation_->host_threads = is_oclgrind(chosen.description) ? 1u
                                    : threads > 0                   ? static_cast<unsigned>(threads)
                                                                    : std::max(1u, std::thread::hardware_concurrency());
    opencl_call("opening the device " + chosen.description.name, [&] {
        implementation_->context = cl::Context(chosen.device);
        implementation_->queue = cl::CommandQueue(implementation_->context, chosen.device, CL_QUEUE_PROFILING_ENABLE);
    });
}

Device::Device(_cl_context *context, _cl_command_queue *queue) : implementation_(std::make_unique<Implementation>()) {
    if (!context || !queue)
        throw Error(ExitCode::device, "a device needs an OpenCL context and a queue; one of them is null");
    opencl_call("taking an OpenCL context and queue", [&] {
        Implementation &i = *implementation_;
        i.context = cl::Context(context, true);
        i.queue = cl::CommandQueue(queue, true);
        if (i.queue.getInfo<CL_QUEUE_CONTEXT>()() != context)
            throw Error(ExitCode::device, "the OpenCL queue belongs to another context");
        const cl_command_queue_properties properties = i.queue.getInfo<CL_QUEUE_PROPERTIES>();
        if (properties & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE)
            throw Error(ExitCode::device, "the OpenCL queue runs out of order; make one without "
                                          "CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE");
        i.profiles = properties & CL_QUEUE_PROFILING_ENABLE;
        i.device = i.queue.getInfo<CL_QUEUE_DEVICE>();
        i.description = describe(cl::Platform(i.device.getInfo<CL_DEVICE_PLATFORM>()), i.device);
        i.store = ProgramStore(program_cache_folder());
        i.host_threads = std::max(1u, std::thread::hardware_concurrency());
    });
}

Device::~Device() {
    if (implementation_->is_stuck)
        static_cast<void>(implementation_.release());
}

const DeviceDescription &Device::description() const { return implementation_->description; }

void throw_opencl_error(const std::string &doing, const cl::Error &error) {
    const bool memory = error.err() == CL_MEM_OBJECT_ALLOCATION_FAILURE || error.err() == CL_OUT_OF_RESOURCES ||
                        error.err() == CL_OUT_OF_HOST_MEMORY || error.err() == CL_INVALID_BUFFER_SIZE;
    throw Error(ExitCode::device,
                fmt::format("{}: OpenCL error {} in {}{}", doing, error.err(), error.what(),
                            memory ? " (out of memory: try a smaller --batch-size, --photons, --size or scene)" : ""));
}

} // namespace gradus
