// Valid files cut and changed at random: whatever comes of it, it is a scene or an Error, never a crash. Worth most
// in a build with sanitizers.
#include "runtime/io/diagnostics.h"
#include "runtime/io/mesh_files.h"
#include "tests/io/mesh_text.h"
#include "tests/io/scene_text.h"

#include <random>

namespace gradus {
namespace {

/// A copy with a few bytes changed, cut out or doubled.
std::string mutated(std::string data, std::mt19937 &random) {
    const int changes = 1 + int(random() % 4);
    for (int i = 0; i < changes && !data.empty(); ++i) {
        const std::size_t at = random() % data.size();
        switch (random() % 6) {
        case 0:
            data.resize(at);
            break;
        case 1:
            data[at] = char(random());
            break;
        case 2:
            data[at] = char(data[at] ^ (1 << (random() % 8)));
            break;
        case 3:
            data.erase(at, random() % 16);
            break;
        case 4:
            data.insert(at, data.substr(at, random() % 16));
            break;
        default:
            data[at] = "0123456789<>\"/$-eE:, \n"[random() % 22];
        }
    }
    return data;
}

/// Its parameter: how many times as many mutations as a quick run takes.
class Fuzz : public ::testing::TestWithParam<int> {
  protected:
    int count(int of_quick_run) const { return GetParam() * of_quick_run; }
};

INSTANTIATE_TEST_SUITE_P(Quick, Fuzz, ::testing::Values(1));
INSTANTIATE_TEST_SUITE_P(Full, Fuzz, ::testing::Values(50));

/// Calls `load` with `count` mutations, of which some must be accepted and some not.
template <typename Load>
void load_mutations(const std::string &valid, int count, Load &&load) {
    std::mt19937 random(20240117);
    int accepted = 0;
    for (int i = 0; i < count; ++i) {
        const std::string data = mutated(valid, random);
        SCOPED_TRACE("mutation " + std::to_string(i));
        try {
            load(data);
            ++accepted;
        } catch (const SceneError &) {
        } catch (const Error &error) {
            EXPECT_EQ(error.code, ExitCode::scene);
        } // anything else ends the test
    }
    EXPECT_GT(accepted, 0);
    EXPECT_LT(accepted, count);
}

void check_indices(const Mesh &mesh) {
    ASSERT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size());
    ASSERT_TRUE(mesh.texcoords.empty() || mesh.texcoords.size() == mesh.positions.size());
    for (const auto &triangle : mesh.triangles)
        for (std::uint32_t index : triangle)
            ASSERT_LT(index, mesh.positions.size());
    for (const MeshAttribute &attribute : mesh.attributes)
        ASSERT_EQ(attribute.values.size(),
                  attribute.channels * (is_by_face(attribute.name) ? mesh.triangles.size() : mesh.positions.size()));
}

TEST_P(Fuzz, Obj) {
    const std::string valid = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nvt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\n"
                              "f -4//1 -2//-1 -1//1\nf 1 2 3 4\n";
    load_mutations(valid, count(20000), [](const std::string &data) { check_indices(parse_obj(data, "m.obj")); });
}

TEST_P(Fuzz, Ply) {
    const std::string ascii =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty list uchar int extra\nelement face 2\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 1 7\n1 0 0 0\n1 1 0 0\n0 1 1 2 3 4\n3 0 1 2\n4 0 1 2 3\n";
    const std::string attributes =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
        "r\nproperty uchar g\nproperty uchar b\nelement face 2\nproperty float a_0\nproperty list uchar int "
        "vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 4 5 6\n1 1 0 7 8 9\n0.5 3 0 1 2\n0.25 4 0 1 2 0\n";
    for (const std::string &valid :
         {ascii, attributes, binary_ply(folded_square(), false), binary_ply(folded_square(), true)})
        load_mutations(valid, count(20000), [](const std::string &data) {
            check_indices(parse_ply(data, "m.ply", {"vertex_color", "face_a"}));
        });
}

TEST_P(Fuzz, Serialized) {
    for (std::uint16_t version : {3, 4}) {
        SerializedOptions options;
        options.version = version;
        options.colors = true;
        const std::string valid = serialized_file({folded_square(), folded_square()}, options);
        load_mutations(valid, count(5000), [](const std::string &data) {
            check_indices(parse_serialized(data, "m", 0, {}, {"vertex_color"}).mesh);
            check_indices(parse_serialized(data, "m", 1).mesh);
        });
        // What the zlib stream holds, too: wrong there and right in its checksum.
        load_mutations(serialized_payload(folded_square(), options), count(5000), [&](const std::string &payload) {
            std::string file("\x1c\x04", 2);
            append_bytes(file, version);
            file += deflated(payload);
            if (version == 3)
                append_bytes<std::uint32_t>(file, 0);
            else
                append_bytes<std::uint64_t>(file, 0);
            append_bytes<std::uint32_t>(file, 1);
            check_indices(parse_serialized(file, "m", 0, {}, {"vertex_color"}).mesh);
        });
    }
}

TEST_P(Fuzz, Scene) {
    TemporaryFolder folder;
    folder.write("m.ply", binary_ply(folded_square(), false));
    const std::string valid =
        "<?xml version='1.0'?>\n<scene version=\"3.0.0\">\n<default name=\"spp\" value=\"4\"/>\n"
        "<integrator type=\"path\"><integer name=\"max_depth\" value=\"3\"/></integrator>\n"
        "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/><transform name=\"to_world\"><lookat "
        "origin=\"0 0 5\" target=\"0 0 0\" up=\"0 1 0\"/></transform><sampler type=\"independent\"><integer "
        "name=\"sample_count\" value=\"$spp\"/></sampler><film type=\"hdrfilm\"><integer name=\"width\" "
        "value=\"64\"/><rfilter type=\"tent\"/></film></sensor>\n"
        "<bsdf type=\"twosided\" id=\"a\"><bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/>"
        "<float name=\"alpha\" value=\"0.2\"/></bsdf></bsdf>\n<bsdf type=\"diffuse\" id=\"b\"><spectrum "
        "name=\"reflectance\" value=\"400:0.1, 700:0.4\"/></bsdf>\n"
        "<shape type=\"ply\"><string name=\"filename\" value=\"m.ply\"/><ref id=\"a\"/><transform "
        "name=\"to_world\"><rotate x=\"1\" angle=\"30\"/><scale value=\"2\"/><matrix value=\"1 0 0 0 1 0 0 0 "
        "1\"/></transform></shape>\n<shape type=\"sphere\"><point name=\"center\" x=\"1\" y=\"2\" z=\"3\"/><ref "
        "id=\"b\"/><emitter type=\"area\"><rgb name=\"radiance\" value=\"1, 2, 3\"/></emitter></shape>\n"
        "<emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-1\" z=\"0\"/></emitter>\n</scene>\n";
    ASSERT_EQ(error_of(folder.write("scene.xml", valid)), "");
    load_mutations(valid, count(3000), [&](const std::string &data) {
        for (const Mesh &mesh : load_scene(folder.write("scene.xml", data)).scene.meshes)
            check_indices(mesh);
    });
}

} // namespace
} // namespace gradus
