// In gradus-compile, the passes of PoCL 5 and 6 get to know the processor that they compile for.
//
// These versions set LLVM's passes up without one (pocl pull request 1535, which is in 7): for no processor do vectors
// pay, so nothing is vectorised, and renders take about twice as long (docs/design.md). They have LLVM set up its
// passes by a constructor of LLVM's library, and the loader finds the one here first, since the program exports it
// (runtime/CMakeLists.txt). It does what LLVM's does, with the processor of the call before where there is none. Where
// PoCL or LLVM are others, nobody calls it, or always with a processor.
#include "runtime/compiler/symbol_name.h"
#include "runtime/device/loaded_library.h"

#include <array>
#include <cstdint>
#include <cstdlib>

namespace {

/// llvm::PipelineTuningOptions, and what lies behind it: its size differs from version to version. It is given by
/// value, so what is handed on begins with all of it.
struct Options {
    std::array<std::uint64_t, 16> words;
};

// Of LLVM's C interface (llvm-c/TargetMachine.h), whose references are pointers.
using CreateMachine = void *(void *target, const char *triple, const char *processor, const char *features, int level,
                             int relocation, int code_model);
using TextOf = char *(void *machine);
using TargetOf = void *(void *machine);
constexpr int aggressive = 3, position_independent = 2, small = 3; // as PoCL's own

using Construct = void(void *builder, void *machine, Options options, void *profile, void *callbacks);

/// A machine as this one, which stays for as long as the process: PoCL deletes its own.
void *copy_of(void *machine) {
    const auto create = gradus::function_of_llvm<CreateMachine>("LLVMCreateTargetMachine");
    const auto target = gradus::function_of_llvm<TargetOf>("LLVMGetTargetMachineTarget");
    const auto triple = gradus::function_of_llvm<TextOf>("LLVMGetTargetMachineTriple");
    const auto processor = gradus::function_of_llvm<TextOf>("LLVMGetTargetMachineCPU");
    const auto features = gradus::function_of_llvm<TextOf>("LLVMGetTargetMachineFeatureString");
    if (!create || !target || !triple || !processor || !features)
        return nullptr;
    return create(target(machine), triple(machine), processor(machine), features(machine), aggressive,
                  position_independent, small);
}

} // namespace

#define PASS_BUILDER                                                                                                   \
    _ZN4llvm11PassBuilderC1EPNS_13TargetMachineENS_21PipelineTuningOptionsESt8optionalINS_10PGOOptionsEEPNS_28PassInstrumentationCallbacksE

extern "C" void PASS_BUILDER(void *builder, void *machine, Options options, void *profile, void *callbacks);

/// llvm::PassBuilder::PassBuilder(llvm::TargetMachine *, llvm::PipelineTuningOptions, std::optional<llvm::PGOOptions>,
/// llvm::PassInstrumentationCallbacks *)
extern "C" void PASS_BUILDER(void *builder, void *machine, Options options, void *profile, void *callbacks) {
    const auto construct = gradus::function_of_llvm<Construct>(SYMBOL_NAME(PASS_BUILDER));
    if (!construct)
        std::abort(); // who started this process compiles by himself then
    // PoCL compiles under a lock.
    static void *known = nullptr;
    if (machine && !known)
        known = copy_of(machine);
    construct(builder, machine ? machine : known, options, profile, callbacks);
}
