// Of a kernel source, what its kernels use.
#pragma once

#include <optional>
#include <string>

namespace gradus {

struct NeededSource {
    /// Kernels, and the functions, types and constants that they need, in the order of the source. No macros are left;
    /// #line says where each stood.
    std::string text;
    std::string options; ///< those that were given, less the definitions that the text is of now
    std::string meaning; ///< equal ones, equal code: the tokens of the text alone, without files and lines
};

/// A source of the whole of kernels/lib has 400,000 characters, of which a kernel in one scene needs a tenth. Sources
/// that differ in what none of their kernels uses (a trait of the scene, another kernel's column) become the same.
/// `options` as those of clBuildProgram; definitions that begin with an underscore are for the compiler's own headers
/// and stay. None where the text is not understood (preprocessor.h).
std::optional<NeededSource> needed_source(const std::string &text, const std::string &options);

} // namespace gradus
