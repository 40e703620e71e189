#include "runtime/io/diagnostics.h"
#include "runtime/io/material_library.h"
#include "runtime/io/mesh_files.h"
#include "tests/fuzz/fuzz_mesh.h"

namespace {

/// The whole file as one mesh, then as one for each material, which have the same faces.
void read_obj(const std::string &text) {
    const gradus::Mesh whole = gradus::parse_obj(text, "m.obj");
    const gradus::ObjFile file(text, "m.obj");
    std::size_t triangles = 0;
    for (const std::string &material : gradus::names_in_obj(text).materials) {
        gradus::require(file.has_material(material));
        const gradus::Mesh part = file.mesh({{material}, false});
        triangles += part.triangles.size();
        gradus::check_mesh(part);
    }
    gradus::require(triangles == whole.triangles.size());
    gradus::check_mesh(whole);
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    const std::string text(reinterpret_cast<const char *>(data), size);
    try {
        read_obj(text);
    } catch (const gradus::SceneError &) {
    }
    try {
        gradus::parse_mtl(text, "m.mtl", [](const std::string &name) { return name.size() < 4; });
    } catch (const gradus::SceneError &) {
    }
    return 0;
}
