// Functions of libraries that this process has loaded already, as OpenCL implementations bring them.
#pragma once

#include <dlfcn.h>

#include <string_view>

namespace gradus {

/// A library by how the name of its file begins, or nullptr. It is not loaded, and stays for as long as the process.
void *loaded_library(std::string_view name);

/// nullptr where the library or the function is missing.
template <class Function>
Function *function_of(void *library, const char *name) {
    return library ? reinterpret_cast<Function *>(dlsym(library, name)) : nullptr;
}

/// Of the LLVM that PoCL is linked to: other OpenCL implementations may have loaded other versions.
template <class Function>
Function *function_of_llvm(const char *name) {
    return function_of<Function>(loaded_library("libpocl.so"), name);
}

} // namespace gradus
