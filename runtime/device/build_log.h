// What an OpenCL compiler says of a source that it does not compile.
#pragma once

#include <string>

namespace gradus {

/// NVIDIA's compiler heeds no `#line`: its log counts the lines of the whole source, which it calls <kernel>. This is
/// the log with the files and lines that the source's directives give. Logs of other compilers stay as they are.
std::string with_file_names(const std::string &log, const std::string &source);

} // namespace gradus
