// What an OpenCL compiler says of a source that it does not compile.
#pragma once

#include <string>

namespace gradus {

/// NVIDIA's compiler heeds no `#line`: its log counts the lines of the whole source, which it calls <kernel>. This is
/// the log with the files and lines that the source's directives give. Logs of other compilers stay as they are.
std::string with_file_names(const std::string &log, const std::string &source);

/// Whether it tells of an error in the source; else it may be the compiler that failed.
bool tells_of_error(const std::string &log);

/// A log that tells of none, with the question whether it is PoCL's folder that fails:
/// $POCL_CACHE_DIR, which is empty where it is PoCL's own choice.
std::string with_hint_at_folder(const std::string &log, const std::string &pocl_folder);

} // namespace gradus
