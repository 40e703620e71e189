// Which options a method reads, and which do not go together.
#pragma once

#include <string>
#include <vector>

namespace gradus {

struct MethodRequest;

/// Throws Error(ExitCode::usage) for options that contradict each other or the method.
void check_method_options(const MethodRequest &request);

/// A sentence for each option that was given and that `method` does not read: the render is as it would be without.
/// `method`: as asked for, or what `auto` chose; of `auto` itself no option is unread.
std::vector<std::string> unread_options(const MethodRequest &request, const std::string &method);

} // namespace gradus
