#include "runtime/device/program_code.h"

#include "runtime/device/build_log.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <cstdlib>
#include <utility>
#include <vector>

namespace gradus {

namespace {

std::string without_end(std::string text) {
    while (!text.empty() && text.back() == '\0')
        text.pop_back();
    return text;
}

KernelArguments arguments_of(const cl::Program &program) {
    KernelArguments found;
    cl::Program asked = program; // its createKernels() is not const
    std::vector<cl::Kernel> kernels;
    asked.createKernels(&kernels);
    for (const cl::Kernel &kernel : kernels) {
        std::vector<KernelArgument> &arguments = found[without_end(kernel.getInfo<CL_KERNEL_FUNCTION_NAME>())];
        const cl_uint count = kernel.getInfo<CL_KERNEL_NUM_ARGS>();
        for (cl_uint i = 0; i < count; ++i)
            arguments.push_back({without_end(kernel.getArgInfo<CL_KERNEL_ARG_NAME>(i)),
                                 without_end(kernel.getArgInfo<CL_KERNEL_ARG_TYPE_NAME>(i))});
    }
    return found;
}

/// Calls use(). Where an exception of the compiler flies through OpenCL, the program is never released: compiler_call()
/// says why.
template <class Use>
auto with_program(cl::Program &program, const Use &use) {
    try {
        return use();
    } catch (const cl::Error &) {
        throw;
    } catch (const Error &) {
        throw;
    } catch (...) {
        program() = nullptr;
        throw;
    }
}

} // namespace

BuiltProgram build_source(const cl::Context &context, const cl::Device &device, const ProgramSource &source) {
    cl::Program program(context, source.text);
    return with_program(program, [&] {
        try {
            program.build({device}, source.options.c_str());
        } catch (const cl::Error &error) {
            if (error.err() != CL_BUILD_PROGRAM_FAILURE)
                throw;
            const char *const folder = std::getenv("POCL_CACHE_DIR");
            const std::string log =
                with_file_names(without_end(program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device)), source.text);
            throw Error(ExitCode::device, fmt::format("kernel {} does not compile for {}:\n{}", source.name,
                                                      without_end(device.getInfo<CL_DEVICE_NAME>()),
                                                      with_hint_at_folder(log, folder ? folder : "")));
        }
        KernelArguments kernels = arguments_of(program);
        return BuiltProgram{std::move(program), std::move(kernels)};
    });
}

BuiltProgram load_image(const cl::Context &context, const cl::Device &device, const ProgramImage &image,
                        const std::string &options) {
    const auto *bytes = reinterpret_cast<const unsigned char *>(image.binary.data());
    const cl::Program::Binaries binaries = {{bytes, bytes + image.binary.size()}};
    cl::Program program(context, {device}, binaries);
    // How it is run is not in the code: PoCL flushes denormal numbers for programs that were built so.
    const char *const flush = "-cl-denorms-are-zero";
    with_program(program, [&] {
        program.build({device}, options.find(flush) != std::string::npos ? flush : "");
        for (const auto &[name, arguments] : image.kernels)
            if (cl::Kernel(program, name.c_str()).getInfo<CL_KERNEL_NUM_ARGS>() != arguments.size())
                throw cl::Error(CL_INVALID_BINARY, "clCreateKernel");
    });
    return {std::move(program), image.kernels};
}

ProgramImage image_of(const BuiltProgram &program) {
    const auto binaries = program.program.getInfo<CL_PROGRAM_BINARIES>();
    if (binaries.empty() || binaries.front().empty())
        throw cl::Error(CL_INVALID_BINARY, "clGetProgramInfo");
    return {program.kernels, std::string(binaries.front().begin(), binaries.front().end())};
}

std::string builtin_options(const DeviceDescription &device) {
    // _OPENCL_H_ is the include guard of clang's opencl-c.h; types are in another header.
    return std::string(is_pocl_cpu(device) ? " -D GRADUS_OF_POCL" : "") +
           (is_pocl_3_1_cpu(device) ? " -D _OPENCL_H_ -D GRADUS_DECLARE_BUILTINS" : "");
}

std::string pocl_specialization(std::uint32_t work_group_size) {
    return fmt::format("{}-1-1-goffs0-smallgrid", work_group_size);
}

} // namespace gradus
