#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/fuzz/fuzz_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    try {
        gradus::check_mesh(gradus::parse_ply(std::string(reinterpret_cast<const char *>(data), size), "m.ply",
                                             gradus::wanted_attributes));
    } catch (const gradus::SceneError &) {
    }
    return 0;
}
