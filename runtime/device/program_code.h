// Making programs of source and of code, for the files of runtime/device only.
#pragma once

#include "runtime/device/opencl.h"
#include "runtime/device/program_image.h"

#include <cstdint>
#include <string>

namespace gradus {

struct ProgramSource {
    std::string name; ///< for messages
    std::string text, options;
};

struct BuiltProgram {
    cl::Program program;
    KernelArguments kernels;
    std::string key{}, options{}; ///< in the store, where it is there, and those that it is loaded with
};

/// Throws Error with the compiler's log.
BuiltProgram build_source(const cl::Context &context, const cl::Device &device, const ProgramSource &source);

/// Throws cl::Error where the device does not take the code.
/// `options`: those that the source was built with; some say how code is run.
BuiltProgram load_image(const cl::Context &context, const cl::Device &device, const ProgramImage &image,
                        const std::string &options);

/// The program's code. PoCL gives it as POCL_BINARY_SPECIALIZE_WG says (pocl_specialization()). Throws cl::Error.
ProgramImage image_of(const BuiltProgram &program);

/// Options for the source of embedded kernels. PoCL reads the header with all of OpenCL's built-in functions for each
/// program: 60 of the 70 ms that its front end takes for most. Where these macros are defined it does not, and
/// kernels/shared/builtins.h declares the few that kernels call. Empty for other implementations and versions.
std::string builtin_options(const DeviceDescription &device);

/// The value of POCL_BINARY_SPECIALIZE_WG with which PoCL's binaries hold the code that all launches use: work-groups
/// of this size, no offset, lines narrower than 65536 work-items.
std::string pocl_specialization(std::uint32_t work_group_size);

} // namespace gradus
