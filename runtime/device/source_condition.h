// Conditions of #if (C11, 6.10.1).
#pragma once

#include "runtime/device/source_lexer.h"

#include <cstdint>
#include <vector>

namespace gradus {

/// Of tokens whose macros are expanded: names that are left are 0. Throws NotUnderstood.
std::int64_t value_of_condition(const std::vector<SourceToken> &tokens);

} // namespace gradus
