#include "runtime/device/pocl_bitcode.h"

#include "runtime/device/loaded_library.h"

namespace gradus {

void trim_pocl_bitcode(const std::filesystem::path &program) {
    // Of LLVM's C interface (llvm-c/Core.h, BitReader.h, BitWriter.h, Transforms/IPO.h), whose references are pointers.
    void *const llvm = loaded_library("libLLVM-15"); // PoCL's of Debian 12
    const auto create_context = function_of<void *()>(llvm, "LLVMContextCreate");
    const auto discard_names = function_of<void(void *, int)>(llvm, "LLVMContextSetDiscardValueNames");
    const auto set_handler =
        function_of<void(void *, void (*)(void *, void *), void *)>(llvm, "LLVMContextSetDiagnosticHandler");
    const auto read_file =
        function_of<int(const char *, void **, char **)>(llvm, "LLVMCreateMemoryBufferWithContentsOfFile");
    const auto parse = function_of<int(void *, void *, void **)>(llvm, "LLVMParseBitcodeInContext2");
    const auto create_passes = function_of<void *()>(llvm, "LLVMCreatePassManager");
    const auto add_global_dce = function_of<void(void *)>(llvm, "LLVMAddGlobalDCEPass");
    const auto run_passes = function_of<int(void *, void *)>(llvm, "LLVMRunPassManager");
    const auto write_file = function_of<int(void *, const char *)>(llvm, "LLVMWriteBitcodeToFile");
    const auto dispose_passes = function_of<void(void *)>(llvm, "LLVMDisposePassManager");
    const auto dispose_module = function_of<void(void *)>(llvm, "LLVMDisposeModule");
    const auto dispose_buffer = function_of<void(void *)>(llvm, "LLVMDisposeMemoryBuffer");
    const auto dispose_context = function_of<void(void *)>(llvm, "LLVMContextDispose");
    const auto dispose_message = function_of<void(char *)>(llvm, "LLVMDisposeMessage");
    if (!create_context || !discard_names || !set_handler || !read_file || !parse || !create_passes ||
        !add_global_dce || !run_passes || !write_file || !dispose_passes || !dispose_module || !dispose_buffer ||
        !dispose_context || !dispose_message)
        return;
    void *buffer = nullptr, *module = nullptr;
    char *message = nullptr;
    if (read_file(program.c_str(), &buffer, &message) != 0) {
        dispose_message(message);
        return;
    }
    void *const context = create_context();
    discard_names(context, 1); // of values within functions: those of kernels and of local memory stay
    set_handler(
        context, [](void *, void *) {}, nullptr); // it warns of what clang leaves behind
    if (parse(context, buffer, &module) == 0) {
        void *const passes = create_passes();
        add_global_dce(passes);
        run_passes(passes, module);
        // Beside it first: half a file would be no program.
        const std::filesystem::path trimmed = program.string() + ".trimmed";
        std::error_code failure;
        if (write_file(module, trimmed.c_str()) == 0)
            std::filesystem::rename(trimmed, program, failure);
        std::filesystem::remove(trimmed, failure);
        dispose_passes(passes);
        dispose_module(module);
    }
    dispose_buffer(buffer);
    dispose_context(context);
}

} // namespace gradus
