// Scenes, with meshes and a scene to include beside them.
#include "runtime/error.h"
#include "runtime/io/load_scene.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    static const gradus::FuzzFolder folder;
    static const bool written = [] {
        const std::string
            mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            part = "<scene version=\"3.0.0\"><default name=\"a\" value=\"b\"/><shape type=\"cube\"/></scene>";
        folder.write("m.obj", mesh.data(), mesh.size());
        folder.write("p.xml", part.data(), part.size());
        return true;
    }();
    (void)written;
    gradus::LoadOptions options;
    options.confined = true;
    try {
        const gradus::Scene scene = gradus::load_scene(folder.write("s.xml", data, size), options).scene;
        for (const gradus::Mesh &mesh : scene.meshes)
            gradus::check_mesh(mesh);
        for (const gradus::Shape &shape : scene.shapes) {
            gradus::require(shape.material < scene.materials.size());
            gradus::require(shape.emitter < std::int32_t(scene.emitters.size()));
        }
    } catch (const gradus::Error &) {
    }
    return 0;
}
