#include "runtime/device/program.h"

#include "runtime/device/kernel_source.h"
#include "runtime/device/launch_observer.h"
#include "runtime/device/opencl.h"
#include "runtime/device/program_builder.h"
#include "runtime/device/program_code.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <utility>

namespace gradus {

struct Kernel::Handle {
    KernelRequest request;
    Device::Implementation *device = nullptr;
    Precision precision = Precision::single;
    std::uint32_t work_group_size = default_work_group_size;
    cl::Kernel kernel;
    std::map<std::string, cl_uint> arguments; ///< index by name
    std::vector<bool> is_set;
    Usage usage;
    std::vector<cl::Event> pending;
    bool is_observed = false; ///< then what follows is kept
    TraitValues traits;
    std::map<std::string, Launch::Argument> values;

    void collect() {
        for (const cl::Event &event : pending) {
            event.wait();
            usage.seconds += 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                        event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
        }
        pending.clear();
    }

    template <class Value>
    void set(const std::string &argument, std::size_t bytes, const void *bits, const Value &value) {
        const auto found = arguments.find(argument);
        if (found == arguments.end())
            return;
        opencl_call("setting " + argument + " of " + request.name, [&] { kernel.setArg(found->second, bytes, bits); });
        is_set[found->second] = true;
        if (is_observed)
            values[argument].value = value;
    }

    /// Tells the device's observer, which is not told of what it launches itself.
    void observe(std::size_t items, std::size_t lines, std::size_t planes) {
        if (!is_observed || !device->observer)
            return;
        const LaunchObserver observer = std::exchange(device->observer, nullptr);
        observer({request, traits, values, items, lines, planes});
        device->observer = observer;
    }

    /// Enqueues `planes` times `lines` times `groups` work-groups, for `items` work-items in all.
    void enqueue(std::size_t groups, std::size_t lines, std::size_t planes, std::size_t items);
};

namespace {

// PoCL compiles a kernel once for launches that are narrower than 65536 work-items in all dimensions, and once more for
// others.
constexpr std::size_t widest_line = 1u << 15;

} // namespace

const std::string &Kernel::name() const { return handle_->request.name; }

std::vector<std::string> Kernel::argument_names() const {
    std::vector<std::string> names;
    for (const auto &[name, index] : handle_->arguments)
        names.push_back(name);
    return names;
}

void Kernel::bind(const std::string &argument, const Buffer &buffer) {
    handle_->set(argument, sizeof(cl_mem), buffer.argument(), buffer);
}

void Kernel::set(const std::string &argument, std::uint32_t value) {
    handle_->set(argument, sizeof value, &value, value);
}

void Kernel::set_real(const std::string &argument, double value) {
    const float single = static_cast<float>(value);
    if (handle_->precision == Precision::double_)
        handle_->set(argument, sizeof value, &value, value);
    else
        handle_->set(argument, sizeof single, &single, value);
}

void Kernel::launch(std::size_t items) { launch_planes(items, 1); }

void Kernel::launch_planes(std::size_t items, std::size_t planes) {
    if (items == 0 || planes == 0)
        return;
    const std::size_t group = handle_->work_group_size, groups = (items + group - 1) / group;
    const std::size_t lines = (groups * group + widest_line - 1) / widest_line;
    handle_->observe(items, 0, planes);
    handle_->enqueue((groups + lines - 1) / lines, lines, planes, items * planes);
}

void Kernel::launch(std::size_t items, std::size_t lines) {
    if (items == 0 || lines == 0)
        return;
    const std::size_t group = handle_->work_group_size;
    handle_->observe(items, lines, 1);
    handle_->enqueue((items + group - 1) / group, lines, 1, items * lines);
}

void Kernel::Handle::enqueue(std::size_t groups, std::size_t lines, std::size_t planes, std::size_t items) {
    for (const auto &[argument, index] : arguments)
        if (!is_set[index])
            throw std::logic_error("kernel " + request.name + ": argument " + argument + " was not set");
    restore_code(*device);
    const bool profiles = device->profiles;
    compiler_call(*device, "launching " + request.name, [&] {
        cl::Event event;
        device->queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(groups * work_group_size, lines, planes),
                                           cl::NDRange(work_group_size, 1, 1), nullptr, profiles ? &event : nullptr);
        if (profiles)
            pending.push_back(std::move(event));
    });
    usage.launches += 1;
    usage.items += items;
    if (pending.size() >= 256)
        opencl_call("timing " + request.name, [&] { collect(); });
}

Kernel::Usage Kernel::usage() const {
    opencl_call("timing " + name(), [&] { handle_->collect(); });
    return handle_->usage;
}

void Kernel::reset_usage() {
    opencl_call("timing " + name(), [&] { handle_->collect(); });
    handle_->usage = {};
}

KernelLibrary::KernelLibrary(Device &device, TraitValues traits, Precision precision, std::uint32_t work_group_size)
    : device_(device), traits_(std::move(traits)), precision_(precision),
      work_group_size_(work_group_size ? work_group_size : default_work_group_size) {
    const DeviceDescription &d = device.description();
    if (precision == Precision::double_ && !d.has_double)
        throw Error(ExitCode::device, fmt::format("{} has no double precision (cl_khr_fp64)", d.name));
}

namespace {

std::string options_for(const DeviceDescription &device, const KernelRequest &request, const KernelSource &source,
                        const TraitValues &traits, Precision precision, std::uint32_t work_group_size) {
    std::string options = fmt::format("-cl-std=CL1.2 -cl-kernel-arg-info -D WORK_GROUP_SIZE={}{}", work_group_size,
                                      builtin_options(device));
    if (precision == Precision::double_)
        options += " -D GRADUS_DOUBLE";
    else
        options += " -cl-single-precision-constant -cl-denorms-are-zero";
    if (precision == Precision::relaxed && !request.strict)
        options += " -cl-fast-relaxed-math";
    for (const std::string &name : source.traits) {
        if (request.definitions.contains(name))
            continue; // this kernel's own
        const auto found = traits.find(name);
        options += fmt::format(" -D {}={}", name, found == traits.end() ? 0 : found->second);
    }
    for (const auto &[name, value] : request.definitions)
        options += fmt::format(" -D {}={}", name, value);
    return options;
}

void dump(const std::string &folder, const KernelRequest &request, const std::string &options,
          const std::string &text) {
    std::string file = request.name;
    for (char &c : file)
        c = c == ' ' ? '-' : c;
    std::filesystem::create_directories(folder);
    std::ofstream out(std::filesystem::path(folder) / (file + ".cl"));
    out << "// options: " << options << "\n" << text;
    if (!out)
        throw Error(ExitCode::output, "cannot write kernel sources to " + folder);
}

} // namespace

std::vector<Kernel> KernelLibrary::build(const std::vector<KernelRequest> &requests, const Progress &progress,
                                         const std::string &dump_folder) {
    Device::Implementation &d = device_.implementation();
    std::vector<ProgramSource> sources;
    for (const KernelRequest &request : requests) {
        const KernelSource &file = kernel_source(request.file);
        const std::string options = options_for(d.description, request, file, traits_, precision_, work_group_size());
        if (!dump_folder.empty())
            dump(dump_folder, request, options, file.text);
        sources.push_back({request.name, file.text, options});
    }

    std::size_t built = 0;
    const auto programs = opencl_call("compiling kernels", [&] {
        return obtain_programs(d, sources, work_group_size(), [&](std::size_t i, double seconds) {
            ++built;
            if (progress)
                progress(requests[i].name, built, requests.size(), seconds);
        });
    });

    std::vector<Kernel> kernels(requests.size());
    for (std::size_t i = 0; i < requests.size(); ++i) {
        auto handle = std::make_shared<Kernel::Handle>();
        handle->request = requests[i];
        handle->device = &d;
        handle->precision = precision_;
        handle->work_group_size = work_group_size();
        handle->is_observed = static_cast<bool>(d.observer);
        if (handle->is_observed)
            handle->traits = traits_;
        compiler_call(d, "making kernel " + requests[i].name,
                      [&] { handle->kernel = cl::Kernel(programs[i]->program, requests[i].entry.c_str()); });
        cl_uint index = 0;
        for (const KernelArgument &argument : programs[i]->kernels.at(requests[i].entry)) {
            handle->arguments[argument.name] = index++;
            if (handle->is_observed)
                handle->values[argument.name].type = argument.type;
        }
        handle->is_set.assign(index, false);
        kernels[i].handle_ = std::move(handle);
    }
    return kernels;
}

void observe_launches(Device &device, LaunchObserver observer) {
    device.implementation().observer = std::move(observer);
}

std::shared_ptr<void> keep_compilers(Device &device) { return compile_workers(device.implementation()); }

void finish(Device &device) {
    opencl_call("waiting for the device", [&] { device.implementation().queue.finish(); });
}

std::uint64_t peak_device_bytes(Device &device) { return device.implementation().peak_bytes; }

} // namespace gradus
