// Scenes by others, where they lie beside the project.
#include "runtime/scene/mesh_builder.h"
#include "runtime/scene/traits.h"
#include "tests/io/scene_text.h"

namespace gradus {
namespace {

LoadedScene load_shared(const std::string &name) {
    const std::filesystem::path path = std::filesystem::path(GRADUS_SHARED_SCENES) / name;
    return load_scene(path.string());
}

#define SKIP_WITHOUT_SHARED_SCENES()                                                                                   \
    if (!std::filesystem::is_directory(GRADUS_SHARED_SCENES))                                                          \
    GTEST_SKIP() << "no folder " << GRADUS_SHARED_SCENES

TEST(SharedScenes, CornellBox) {
    SKIP_WITHOUT_SHARED_SCENES();
    const LoadedScene loaded = load_shared("cornell-box/scene.xml");
    const Scene &scene = loaded.scene;
    EXPECT_THAT(loaded.warnings, testing::IsEmpty());
    EXPECT_EQ(scene.meshes.size(), 8u);
    EXPECT_EQ(scene.materials.size(), 8u);
    EXPECT_EQ(scene.film.width, 1024u);
    EXPECT_EQ(scene.film.filter, FilmSettings::Filter::box);
    EXPECT_EQ(scene.settings.max_depth, 30);
    EXPECT_EQ(scene.settings.samples_per_pixel, 64u);
    EXPECT_DOUBLE_EQ(scene.camera.fov, 19.5);
    ASSERT_EQ(scene.emitters.size(), 1u);
    expect_rgb(scene.emitters[0].value, 17, 12, 4);
    EXPECT_EQ(scene.shapes[7].name, "Light");
    EXPECT_NEAR(surface_area(scene.meshes[7]), 4 * 0.235 * 0.19, 1e-5);
    // The light hangs from the ceiling and shines down.
    const Mesh &light = scene.meshes[7];
    const auto &t = light.triangles[0];
    const Vector3 a = light.positions[t[0]], b = light.positions[t[1]], c = light.positions[t[2]];
    EXPECT_LT((b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z), 0);
}

TEST(SharedScenes, Torus) {
    SKIP_WITHOUT_SHARED_SCENES();
    for (const char *name : {"torus/scene.xml", "torus/scene-soft.xml"}) {
        const LoadedScene loaded = load_shared(name);
        const Scene &scene = loaded.scene;
        const bool is_soft = std::string(name) == "torus/scene-soft.xml";
        EXPECT_THAT(loaded.warnings, testing::IsEmpty());
        ASSERT_EQ(scene.meshes.size(), is_soft ? 6u : 5u);
        const std::size_t triangles[] = {2, 16384, 600, 3314, 3314}, vertices[] = {4, 8385, 604, 2488, 2488};
        for (int i = 0; i < 5; ++i) {
            EXPECT_EQ(scene.meshes[i].triangles.size(), triangles[i]);
            EXPECT_EQ(scene.meshes[i].positions.size(), vertices[i]);
            EXPECT_EQ(scene.meshes[i].normals.size(), vertices[i]);
        }
        const Bsdf &glass = scene.materials[scene.shapes[2].material].front;
        EXPECT_THAT(bsdf_kind_name(glass), testing::StartsWith("roughdielectric"));
        EXPECT_FLOAT_EQ(glass.alpha_u, is_soft ? 0.05f : 0.01f);
        EXPECT_FLOAT_EQ(glass.ior, float(1.49 / 1.000277));
        EXPECT_EQ(scene.emitters.size(), is_soft ? 2u : 1u);
        EXPECT_EQ(scene.settings.rr_depth, 8);
    }
}

TEST(SharedScenes, VeachMis) {
    SKIP_WITHOUT_SHARED_SCENES();
    const LoadedScene loaded = load_shared("veach-mis/scene.xml");
    const Scene &scene = loaded.scene;
    EXPECT_THAT(loaded.warnings, testing::IsEmpty());
    EXPECT_EQ(scene.spheres.size(), 3u);
    EXPECT_EQ(scene.meshes.size(), 6u);
    EXPECT_EQ(scene.emitters.size(), 3u);
    EXPECT_EQ(scene.materials.size(), 6u);
    EXPECT_EQ(scene.settings.max_depth, 3);
    EXPECT_FLOAT_EQ(scene.spheres[2].radius, 0.05f);
    expect_vector(scene.spheres[2].center, 0, 6.5, 2.7);
    const Bsdf &smooth = scene.materials[scene.shapes[0].material].front;
    EXPECT_FLOAT_EQ(smooth.alpha_u, 0.01f);
    expect_rgb(smooth.eta, 0.200438, 0.924033, 1.10221);
    expect_rgb(smooth.specular_reflectance, 0.3, 0.3, 0.3);
}

} // namespace
} // namespace gradus
