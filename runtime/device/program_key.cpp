#include "runtime/device/program_key.h"

#include "runtime/device/byte_text.h"
#include "runtime/device/hash.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gradus {

namespace {

/// Model and features of the first processor as the kernel of the system lists them: a virtual machine may hide some.
std::string processor() {
    std::ifstream file("/proc/cpuinfo");
    std::string text;
    for (std::string line; std::getline(file, line) && !line.empty();)
        if (line.starts_with("model name") || line.starts_with("flags") || line.starts_with("Features"))
            text += line + '\n';
    return text;
}

/// PoCL's variables but those that do not change code: folders, threads and what is told.
std::vector<std::string> compiler_variables() {
    const char *const harmless[] = {"POCL_CACHE_DIR",        "POCL_DEBUG",           "POCL_MAX_PTHREAD_COUNT",
                                    "POCL_CPU_MAX_CU_COUNT", "POCL_CPU_NUM_WORKERS", "POCL_AFFINITY",
                                    "POCL_MAX_COMPUTE_UNITS"};
    std::vector<std::string> variables;
    for (char **variable = environ; variable && *variable; ++variable) {
        const std::string text = *variable;
        const bool is_harmless = text.starts_with("POCL_TRACING") ||
                                 std::any_of(std::begin(harmless), std::end(harmless),
                                             [&](const std::string &name) { return text.starts_with(name + '='); });
        if (text.starts_with("POCL_") && !is_harmless)
            variables.push_back(text);
    }
    std::sort(variables.begin(), variables.end());
    return variables;
}

/// Changes with how programs are compiled (pocl_compiler.h, pocl_linker.h, compiler/).
constexpr const char *way_of_compiling = "6";

} // namespace

std::string device_key(const DeviceDescription &device) {
    ByteWriter writer;
    writer.text(way_of_compiling);
    for (const std::string *text : {&device.platform, &device.name, &device.vendor, &device.version, &device.driver,
                                    &device.platform_version, &device.type})
        writer.text(*text);
    if (device.type == "cpu") {
        writer.text(processor());
        for (const std::string &variable : compiler_variables())
            writer.text(variable);
    }
    return writer.bytes();
}

std::string program_key(const std::string &device_key, const std::string &options, const std::string &source) {
    ByteWriter writer;
    for (const std::string *text : {&device_key, &options, &source})
        writer.text(*text);
    return writer.bytes();
}

std::string needed_key(const std::string &device_key, const std::string &options, const std::string &meaning) {
    const std::string whole = program_key(device_key, options, meaning);
    return "needed " + hexadecimal(hash128(whole, 1)) + hexadecimal(hash128(whole, 2));
}

} // namespace gradus
