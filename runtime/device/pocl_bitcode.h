// The intermediate code that PoCL keeps of a program.
#pragma once

#include <filesystem>

namespace gradus {

/// PoCL 3.1 reads the intermediate code of each program that is loaded, though its kernels are compiled: it is for
/// launches of sizes that they are not compiled for. This leaves out of it what no kernel calls and the names of local
/// values: a quarter is left, which is read in a third of the time. To be called once the program is built, and before
/// it is asked for its code. Does nothing where the libraries are others.
void trim_pocl_bitcode(const std::filesystem::path &program);

} // namespace gradus
