// The first byte says whether the rest is a file, or what a stream in a file unfolds to: the search would hardly find
// streams whose checksums are right.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/fuzz/fuzz_mesh.h"
#include "tests/io/mesh_text.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    if (size == 0)
        return 0;
    const std::string rest(reinterpret_cast<const char *>(data) + 1, size - 1);
    std::string file = rest;
    if (data[0] != 'f') {
        const bool is_old = data[0] == '3';
        file = std::string("\x1c\x04", 2) + std::string(is_old ? "\3\0" : "\4\0", 2) + gradus::deflated(rest);
        is_old ? gradus::append_bytes<std::uint32_t>(file, 0) : gradus::append_bytes<std::uint64_t>(file, 0);
        gradus::append_bytes<std::uint32_t>(file, 1);
    }
    try {
        for (std::uint64_t index : {0, 1})
            gradus::check_mesh(gradus::parse_serialized(file, "m", index, {}, gradus::wanted_attributes).mesh);
    } catch (const gradus::SceneError &) {
    }
    return 0;
}
