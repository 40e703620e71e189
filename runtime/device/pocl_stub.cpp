#include "runtime/device/pocl_stub.h"

#include <elf.h>

#include <bit>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <utility>

namespace gradus {

namespace fs = std::filesystem;

namespace {

#if defined(__x86_64__)
constexpr Elf64_Half machine = EM_X86_64;
#elif defined(__aarch64__)
constexpr Elf64_Half machine = EM_AARCH64;
#else
constexpr Elf64_Half machine = EM_NONE;
#endif

/// All of a library but its names, which follow.
struct Library {
    Elf64_Ehdr head;
    Elf64_Phdr load, dynamic_segment, stack;
    Elf64_Dyn dynamic[6];
    Elf64_Sym symbols[2]; ///< the first is always none
    Elf64_Word hash[5];   ///< buckets, symbols, the bucket's first symbol, the next after each
};

} // namespace

std::string library_with_symbol(const std::string &symbol) {
    if constexpr (machine == EM_NONE || std::endian::native != std::endian::little)
        return {};
    const std::string names = std::string(1, '\0') + symbol + '\0';
    const std::size_t size = sizeof(Library) + names.size();
    Library library = {};
    Elf64_Ehdr &head = library.head;
    std::memcpy(head.e_ident, ELFMAG, SELFMAG);
    head.e_ident[EI_CLASS] = ELFCLASS64;
    head.e_ident[EI_DATA] = ELFDATA2LSB;
    head.e_ident[EI_VERSION] = EV_CURRENT;
    head.e_type = ET_DYN;
    head.e_machine = machine;
    head.e_version = EV_CURRENT;
    head.e_phoff = offsetof(Library, load);
    head.e_ehsize = sizeof(Elf64_Ehdr);
    head.e_phentsize = sizeof(Elf64_Phdr);
    head.e_phnum = 3;
    // One page-aligned piece, which the loader may write to, for it turns the addresses below into its own.
    library.load = {PT_LOAD, PF_R | PF_W, 0, 0, 0, size, size, 0x10000};
    constexpr std::size_t place = offsetof(Library, dynamic), length = sizeof library.dynamic;
    library.dynamic_segment = {PT_DYNAMIC, PF_R | PF_W, place, place, place, length, length, 8};
    library.stack = {PT_GNU_STACK, PF_R | PF_W, 0, 0, 0, 0, 0, 16}; // without it, code would run on the stack
    constexpr Elf64_Section any_section = 1; // the loader only sees that it is one
    const auto entry = [](Elf64_Sxword tag, Elf64_Xword value) { return Elf64_Dyn{tag, {value}}; };
    library.dynamic[0] = entry(DT_HASH, offsetof(Library, hash));
    library.dynamic[1] = entry(DT_STRTAB, sizeof(Library));
    library.dynamic[2] = entry(DT_SYMTAB, offsetof(Library, symbols));
    library.dynamic[3] = entry(DT_STRSZ, names.size());
    library.dynamic[4] = entry(DT_SYMENT, sizeof(Elf64_Sym));
    library.symbols[1] = {1, ELF64_ST_INFO(STB_GLOBAL, STT_OBJECT), STV_DEFAULT, any_section, sizeof(Library), 1};
    library.hash[0] = 1;
    library.hash[1] = 2;
    library.hash[2] = 1;
    return std::string(reinterpret_cast<const char *>(&library), sizeof library) + names;
}

PoclStubs::PoclStubs(fs::path cache, const DeviceDescription &device)
    : cache_(device.driver.starts_with("3.1") ? std::move(cache) : fs::path()) {}

std::vector<fs::path> PoclStubs::put(const KernelArguments &kernels) {
    std::vector<fs::path> found;
    if (cache_.empty())
        return found;
    // <cache>/<two letters>/<rest of a hash>/program.bc, and beside it <kernel>/<sizes>/<kernel>.so
    std::error_code failure;
    for (fs::recursive_directory_iterator file(cache_, failure), end; !failure && file != end;
         file.increment(failure)) {
        if (file.depth() == 2)
            file.disable_recursion_pending();
        if (file->path().filename() != "program.bc" || !seen_.insert(file->path()).second)
            continue;
        found.push_back(file->path());
        for (const auto &[kernel, arguments] : kernels) {
            const fs::path place = file->path().parent_path() / kernel / "0-0-0";
            const std::string content = library_with_symbol("_pocl_kernel_" + kernel + "_workgroup");
            std::error_code ignored;
            if (!content.empty() && !fs::exists(place / (kernel + ".so"), ignored)) {
                fs::create_directories(place, ignored);
                std::ofstream(place / (kernel + ".so"), std::ios::binary) << content;
            }
        }
    }
    return found;
}

} // namespace gradus
