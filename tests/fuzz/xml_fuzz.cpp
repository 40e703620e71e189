// Scenes, with meshes, pictures and a scene to include beside them.
#include "runtime/error.h"
#include "runtime/io/load_scene.h"
#include "runtime/scene/traits.h"
#include "tests/fuzz/fuzz_file.h"
#include "tests/fuzz/fuzz_mesh.h"

#include <OpenImageIO/imageio.h>

namespace {

/// Two texels. Tiles, because OpenImageIO takes 16 MB or more for whatever lines it reads: to the sanitizer half of
/// the time of a run.
void write_tiled(const std::string &path, OIIO::TypeDesc type) {
    OIIO::ImageSpec spec(2, 1, 3, type);
    spec.tile_width = spec.tile_height = 16;
    const float values[] = {0.25f, 0.5f, 1, 1, 1, 0.125f};
    const auto output = OIIO::ImageOutput::create(path);
    gradus::require(output && output->open(path, spec) && output->write_image(OIIO::TypeDesc::FLOAT, values) &&
                    output->close());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const unsigned char *data, std::size_t size) {
    static const gradus::FuzzFolder folder;
    static const bool written = [] {
        const std::string
            mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
            part = "<scene version=\"3.0.0\"><default name=\"a\" value=\"b\"/><shape type=\"cube\"/></scene>";
        folder.write("m.obj", mesh.data(), mesh.size());
        const std::string colored = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                    "property float z\nproperty float r\nproperty float g\nproperty float b\nelement "
                                    "face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 1 0 0\n1 0 0 0 "
                                    "1 0\n0 1 0 0 0 1\n3 0 1 2\n";
        folder.write("m.ply", colored.data(), colored.size());
        write_tiled(folder.path() + "/t.exr", OIIO::TypeDesc::FLOAT);
        write_tiled(folder.path() + "/t.tif", OIIO::TypeDesc::UINT8);
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
            gradus::for_each_texture(scene, shape, [&](std::int32_t texture) {
                gradus::require(texture < std::int32_t(scene.textures.size()));
            });
        }
    } catch (const gradus::Error &) {
    }
    return 0;
}
