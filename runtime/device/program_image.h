// A program as it is kept: the device's code, and what OpenCL does not tell of a program that was loaded as code.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gradus {

struct KernelArgument {
    std::string name, type; ///< as the source has them
    bool operator==(const KernelArgument &) const = default;
};

/// The arguments of the kernels of a program, in order, by the name of the kernel.
using KernelArguments = std::map<std::string, std::vector<KernelArgument>>;

struct ProgramImage {
    KernelArguments kernels;
    std::string binary; ///< what clGetProgramInfo gave for the one device
};

std::string to_bytes(const ProgramImage &image);

/// Throws std::runtime_error for what to_bytes() did not write.
ProgramImage program_image(std::string_view bytes);

} // namespace gradus
