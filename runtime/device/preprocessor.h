// What a compiler sees of a kernel source: conditionals decided, macros expanded, comments gone.
#pragma once

#include "runtime/device/source_lexer.h"

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gradus {

/// The tokens live as long as both this and the text that they are of.
struct PreprocessedSource {
    std::vector<SourceToken> tokens;
    std::deque<std::string> made; ///< spellings that are nowhere in the text
};

/// `text` has its includes resolved, `definitions` are as those of -D: "NAME" or "NAME=VALUE". What a device defines by
/// itself is not known here: kernels may ask for __OPENCL_VERSION__ alone, which is given. None where the text has what
/// kernels do not use (#error that is met, # of an argument, an unknown directive) or is wrong: then its compiler is to
/// say so. C11, 6.10.
std::optional<PreprocessedSource> preprocessed(std::string_view text, const std::vector<std::string> &definitions);

} // namespace gradus
