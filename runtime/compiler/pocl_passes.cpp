// In gradus-compile, PoCL's optimisation of a kernel begins with leaving out what nobody launches and with saying how
// wide its vectors are to be, and is done once.
//
// PoCL 3.1 makes three functions of each kernel: the kernel itself, a launcher for work-groups, which is what its CPU
// devices look up, and a "fast" launcher, which they never do. Each contains all of the kernel and is optimised by
// itself: two thirds of the work, and of the code, for nothing.
//
// It also optimises each kernel twice: as the code of one work-item, and again when it has made that of work-groups.
// The second time finds what the first one does, and the first one alone is a tenth of the work.
//
// PoCL has no settings for these. But it has LLVM list its passes by a function of LLVM's library, and the loader finds
// the one here first, since the program exports it (runtime/CMakeLists.txt). It puts two passes in front, leaves the
// first time out, and then does what LLVM's does. Where PoCL or LLVM are others, nobody calls it.
#include "runtime/compiler/pocl_version.h"
#include "runtime/compiler/symbol_name.h"
#include "runtime/device/loaded_library.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <string_view>

namespace {

// Of LLVM's C interface (llvm-c/Core.h, Transforms/IPO.h), whose references are pointers.
using AddAttribute = void(void *function, const char *name, const char *value);
using NameOf = const char *(void *value, std::size_t *length);
using AddInternalize = void(void *passes, void *context, int (*is_kept)(void *value, void *context));
using AddGlobalDce = void(void *passes);
using Populate = void(void *builder, void *passes);
using SetLevel = void(void *builder, unsigned level);

constexpr unsigned level_of_pocl = 3;

NameOf *name_of = nullptr;
AddAttribute *add_attribute = nullptr;

/// Whether a kernel takes sixteen work-items at a time where the processor can, by its launcher. LLVM would have eight
/// of them, as the first processors with AVX-512 were slower else. These kernels wait for one result after the other,
/// so the more side by side the better: with sixteen a row of `shade` takes 0.85 of the time (Zen 4). Kernels that
/// scatter, or hold more than the registers do, are not among them: they take as long or longer.
bool is_wide(std::string_view launcher) {
    static constexpr std::array<std::string_view, 6> wide = {"camera",           "emit",  "escape",
                                                             "gradient_combine", "shade", "photon_reconnect"};
    return std::ranges::any_of(wide, [&](std::string_view kernel) {
        return launcher.starts_with(kernel) && launcher.substr(kernel.size()) == "_workgroup";
    });
}

/// Of the functions that PoCL makes of a kernel the launcher alone. LLVM asks it of each function before it optimises,
/// and nobody else hands them to us: so it is here that launchers are told how wide they are.
int is_kept(void *value, void *) {
    constexpr std::string_view prefix = "_pocl_kernel_";
    std::size_t length = 0;
    const char *text = name_of(value, &length);
    const std::string_view name(text, length);
    if (!name.starts_with(prefix))
        return true;
    if (add_attribute && is_wide(name.substr(prefix.size())))
        add_attribute(value, "prefer-vector-width", "512");
    return name.ends_with("_workgroup");
}

} // namespace

#define POPULATE _ZN4llvm18PassManagerBuilder25populateModulePassManagerERNS_6legacy15PassManagerBaseE

extern "C" void POPULATE(void *builder, void *passes);

/// llvm::PassManagerBuilder::populateModulePassManager(llvm::legacy::PassManagerBase &)
extern "C" void POPULATE(void *builder, void *passes) {
    const auto populate = gradus::function_of_llvm<Populate>(SYMBOL_NAME(POPULATE));
    const auto internalize =
        gradus::function_of_llvm<AddInternalize>("LLVMAddInternalizePassWithMustPreservePredicate");
    const auto remove_unused = gradus::function_of_llvm<AddGlobalDce>("LLVMAddGlobalDCEPass");
    name_of = gradus::function_of_llvm<NameOf>("LLVMGetValueName2");
    add_attribute = gradus::function_of_llvm<AddAttribute>("LLVMAddTargetDependentFunctionAttr");
    if (!populate)
        std::abort(); // who started this process compiles by himself then
    if (internalize && remove_unused && name_of) {
        internalize(passes, nullptr, is_kept);
        remove_unused(passes);
    }
    // PoCL 3.1 lists all passes for a kernel once, those of both times in one list.
    static void *listed = nullptr;
    const auto set_level = gradus::function_of_llvm<SetLevel>("LLVMPassManagerBuilderSetOptLevel");
    const bool is_first_time = set_level && listed != passes && gradus::is_pocl_3_1_loaded();
    listed = is_first_time ? passes : nullptr; // another list may come to lie at the same place
    if (is_first_time)
        set_level(builder, 0);
    populate(builder, passes);
    if (is_first_time)
        set_level(builder, level_of_pocl);
}
