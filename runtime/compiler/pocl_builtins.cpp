// In gradus-compile, PoCL reads of its library of built-in functions what kernels call.
//
// PoCL 3.1 has that library as intermediate code, 9 MB of it, and reads all before the first kernel. Ours call some
// thirty of its ten thousand functions. LLVM can leave a function unread until it is asked for, and PoCL asks for each
// by its name. It has LLVM read the file and find functions by two functions of LLVM's library, and the loader finds
// those here first, since the program exports them (runtime/CMakeLists.txt). For other versions they do what LLVM's do.
#include "runtime/compiler/pocl_version.h"
#include "runtime/compiler/symbol_name.h"
#include "runtime/device/loaded_library.h"

#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace {

/// llvm::StringRef
struct Text {
    const char *begin;
    std::size_t length;
};

/// llvm::function_ref
struct Callback {
    void *function, *object;
};

// std::unique_ptr and llvm::Error are results that a caller has room for, and gives the address of.
using ParseFile = void **(void **module, Text file, void *diagnostic, void *context, Callback layout);
using ParseFileLazily = void **(void **module, Text file, void *diagnostic, void *context, bool metadata_too);
using FindFunction = void *(const void *module, Text name);
using Materialize = void **(void **error, void *function);

/// kernel-PROCESSOR.bc it is called. Programs have other names.
bool is_library(std::string_view file) {
    const std::string_view name = file.substr(file.rfind('/') + 1);
    return name.starts_with("kernel-") && name.ends_with(".bc");
}

} // namespace

#define PARSE_FILE                                                                                                     \
    _ZN4llvm11parseIRFileENS_9StringRefERNS_12SMDiagnosticERNS_11LLVMContextENS_12function_refIFNS_8OptionalINSt7__cxx1112basic_stringIcSt11char_traitsIcESaIcEEEEES0_EEE
#define FIND_FUNCTION _ZNK4llvm6Module11getFunctionENS_9StringRefE

extern "C" ParseFile PARSE_FILE;
extern "C" FindFunction FIND_FUNCTION;

/// llvm::parseIRFile(llvm::StringRef, llvm::SMDiagnostic &, llvm::LLVMContext &, llvm::DataLayoutCallbackTy)
extern "C" void **PARSE_FILE(void **module, Text file, void *diagnostic, void *context, Callback layout) {
    // llvm::getLazyIRFileModule(llvm::StringRef, llvm::SMDiagnostic &, llvm::LLVMContext &, bool)
    const auto parse_lazily = gradus::function_of_llvm<ParseFileLazily>(
        "_ZN4llvm19getLazyIRFileModuleENS_9StringRefERNS_12SMDiagnosticERNS_11LLVMContextEb");
    if (parse_lazily && is_library({file.begin, file.length}) && gradus::is_pocl_3_1_loaded())
        return parse_lazily(module, file, diagnostic, context, false);
    const auto parse = gradus::function_of_llvm<ParseFile>(SYMBOL_NAME(PARSE_FILE));
    if (!parse)
        std::abort(); // who started this process compiles by himself then
    return parse(module, file, diagnostic, context, layout);
}

/// llvm::Module::getFunction(llvm::StringRef) const
extern "C" void *FIND_FUNCTION(const void *module, Text name) {
    static const auto find = gradus::function_of_llvm<FindFunction>(SYMBOL_NAME(FIND_FUNCTION));
    // llvm::GlobalValue::materialize(), which does nothing for a function that has been read
    static const auto materialize = gradus::function_of_llvm<Materialize>("_ZN4llvm11GlobalValue11materializeEv");
    if (!find || !materialize)
        std::abort();
    void *const function = find(module, name);
    void *error = nullptr;
    if (function)
        materialize(&error, function);
    if (error)
        std::abort(); // a damaged library: who started this process may have another
    return function;
}
