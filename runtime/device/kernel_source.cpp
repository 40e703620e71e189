#include "runtime/device/kernel_source.h"

#include "runtime/device/embedded_kernels.h"
#include "runtime/error.h"

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <sstream>
#include <utility>

namespace gradus {

namespace {

const std::string &text_of(const std::string &path, const std::string &includer) {
    for (const EmbeddedKernel &file : embedded_kernels())
        if (file.path == path)
            return file.text;
    throw Error(ExitCode::device, fmt::format("kernel file {} (included by {}) does not exist", path, includer));
}

constexpr std::string_view include_mark = "#include \"";
constexpr std::string_view traits_mark = "//! traits:";

void append(const std::string &path, const std::string &includer, KernelSource &source, std::set<std::string> &seen) {
    if (!seen.insert(path).second)
        return;
    std::istringstream lines(text_of(path, includer));
    source.text += fmt::format("#line 1 \"{}\"\n", path);
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (line.starts_with(include_mark)) {
            const std::size_t end = line.find('"', include_mark.size());
            append(line.substr(include_mark.size(), end - include_mark.size()), path, source, seen);
            source.text += fmt::format("#line {} \"{}\"\n", number + 1, path);
            continue;
        }
        if (line.starts_with(traits_mark)) {
            std::istringstream names(line.substr(traits_mark.size()));
            for (std::string name; names >> name;)
                source.traits.insert(name);
        }
        source.text += line + "\n";
    }
}

} // namespace

const KernelSource &kernel_source(const std::string &path) {
    static std::mutex mutex;
    static std::map<std::string, KernelSource> made;
    const std::lock_guard lock(mutex);
    const auto found = made.find(path);
    if (found != made.end())
        return found->second;
    KernelSource source;
    std::set<std::string> seen;
    append(path, "the runtime", source, seen);
    return made.emplace(path, std::move(source)).first->second;
}

} // namespace gradus
