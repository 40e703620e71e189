// Keeping PoCL from compiling code that no launch uses.
#pragma once

#include "runtime/device/device.h"
#include "runtime/device/program_image.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace gradus {

/// Asked for the code of a program, PoCL 3.1 compiles each kernel for work-groups of any size too, which takes twice as
/// long as the code that is used. It does not where its folder has that already: this puts libraries there that hold
/// the name of the kernel and nothing else. No launch comes to run them: where the code for a size is missing, PoCL
/// compiles it from the program's intermediate code, which is kept as well. Does nothing for other implementations and
/// versions, which then compile more.
class PoclStubs {
  public:
    /// `cache` is PoCL's folder.
    PoclStubs(std::filesystem::path cache, const DeviceDescription &device);
    /// For the kernels of a program that was built since the last call. Returns where its intermediate code is.
    std::vector<std::filesystem::path> put(const KernelArguments &kernels);

  private:
    std::filesystem::path cache_;
    std::set<std::filesystem::path> seen_; ///< programs
};

/// A shared library for this machine whose only symbol is this one; empty for processors that this is not written for.
std::string library_with_symbol(const std::string &symbol);

} // namespace gradus
