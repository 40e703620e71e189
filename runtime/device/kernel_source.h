// Kernel sources, put together: includes resolved, line numbers kept, and the traits that a source declares.
#pragma once

#include <set>
#include <string>

namespace gradus {

struct KernelSource {
    std::string text;             ///< one translation unit with #line directives that name the real files
    std::set<std::string> traits; ///< the names that "//! traits:" lines declare, in the file and all it includes
};

/// The source of an embedded kernel file, by its path from the project's root; put together once, for a renderer asks
/// for dozens of them, of some 200,000 characters each, and a process may make many renderers. Throws Error where a
/// file that it includes does not exist.
const KernelSource &kernel_source(const std::string &path);

} // namespace gradus
