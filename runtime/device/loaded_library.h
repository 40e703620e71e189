// Functions of libraries that this process has loaded already, as OpenCL implementations bring them.
#pragma once

#include <dlfcn.h>

#include <string_view>

namespace gradus {

/// A library by how the name of its file begins, or nullptr. It is not loaded, and stays for as long as the process.
void *loaded_library(std::string_view name);

/// LLVM's; nullptr where it is not loaded.
void *loaded_llvm();

/// nullptr where the library or the function is missing.
template <class Function>
Function *function_of(void *library, const char *name) {
    return library ? reinterpret_cast<Function *>(dlsym(library, name)) : nullptr;
}

/// Of LLVM's library.
template <class Function>
Function *function_of_llvm(const char *name) {
    return function_of<Function>(loaded_llvm(), name);
}

} // namespace gradus
