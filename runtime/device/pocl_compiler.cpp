#include "runtime/device/pocl_compiler.h"

#include "runtime/device/loaded_library.h"
#include "runtime/device/opencl.h"
#include "runtime/device/program_code.h"

#include <cstddef>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

namespace gradus {

namespace {

void set_llvm_options(bool is_3_1) {
    using Parse = void(int, const char *const *, const char *);
    const auto parse = function_of_llvm<Parse>("LLVMParseCommandLineOptions");
    if (!parse)
        return;
    std::vector<const char *> options = {
        "gradus-compile", "-vectorize-slp=false",
        "-vectorize-num-stores-pred=1000000"}; // a limit that no kernel of ours reaches
    // Each of some ten passes goes through all expressions once, and not again for as long as any of them changes. LLVM
    // 17 does not know it, and ends the process then.
    if (is_3_1)
        options.push_back("-instcombine-max-iterations=1");
    parse(int(options.size()), options.data(), nullptr);
}

/// The processor that PoCL compiles for: the very text that its record of the device points to. Or nullptr.
const char *processor_of_pocl() {
    void *const library = loaded_library("libpocl.so");
    const auto variant = function_of<const char *()>(library, "pocl_get_distro_kernellib_name");
    const auto processor = function_of<const char *(const char *)>(library, "pocl_get_distro_cpu_name");
    const char *const chosen = variant && processor ? variant() : nullptr;
    return chosen ? processor(chosen) : nullptr;
}

/// PoCL 3.1's record of a device has more words than this.
constexpr std::size_t words_of_device = 160;

} // namespace

void prepare_pocl_compiler(const cl::Context &context, const cl::Device &device, const DeviceDescription &description) {
    const bool is_3_1 = is_pocl_3_1_cpu(description);
    if (is_pocl_5_or_6_cpu(description))
        setenv("POCL_LLVM_ALWAYS_INLINE", "1", 0);
    else if (!is_3_1)
        return;
    set_llvm_options(is_3_1);
    if (!is_3_1)
        return;
    const char *const processor = processor_of_pocl();
    if (!processor || std::string_view(processor) != "haswell")
        return;
    const char **const record = reinterpret_cast<const char **>(device());
    for (std::size_t i = 0; i < words_of_device; ++i)
        if (record[i] == processor) {
            // The first program makes a code generator, which PoCL keeps. After it the word is as it was, so that
            // binaries are marked as those of this device.
            const std::string options = "-cl-kernel-arg-info -w" + builtin_options(description);
            record[i] = "skylake";
            image_of(build_source(context, device, {"nothing", "__kernel void nothing() {}", options}));
            record[i] = processor;
            return;
        }
}

void prepare_pocl_compiler(Device &device) {
    Device::Implementation &implementation = device.implementation();
    prepare_pocl_compiler(implementation.context, implementation.device, device.description());
}

} // namespace gradus
