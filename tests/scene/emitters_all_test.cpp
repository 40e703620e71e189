// Light samples by power of lights of every kind, many with textures.
#define TRAIT_LIGHT_CONSTANT 0
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_LIGHT_TRIANGLE 1
#define TRAIT_LIGHT_SPHERE 1
#define TRAIT_LIGHT_POINT 1
#define TRAIT_LIGHT_DIRECTIONAL 1
#define TRAIT_LIGHT_SPOT 1
#define TRAIT_LIGHT_ENVIRONMENT 1
#define TRAIT_TEXTURED_LIGHTS 7
#define TRAIT_LIGHT_TEXTURES 0xFFFFu // whatever these have
#include "tests/scene/emitter_case.h"

namespace gradus::testing {
namespace {

/// A spot or a projector that looks at the middle from above.
void add_picture(SceneMaker &maker, Emitter::Kind kind, std::int32_t texture, const Vector3 &position) {
    Emitter &emitter = maker.picture(kind, {3, 4, 5}, std::size_t(texture), position, 1.2f, 0.9f);
    emitter.cutoff = 0.6f;
    emitter.beam = 0.2f;
}

Emitters make_case() {
    SceneMaker maker(8, 1);
    add_lamps(maker);
    const std::uint32_t black = maker.material(diffuse(0));
    const auto textured = [&](std::int32_t texture) {
        const std::int32_t emitter = maker.emitter(Emitter::Kind::area, {2, 1, 3});
        maker.scene.emitters[std::size_t(emitter)].texture = texture;
        return emitter;
    };
    maker.parallelogram({-2, -0.5f, -1}, {0, 1, 0.25f}, {0, 0, 1.5f}, black, textured(lamp_texture(maker, 3)));
    maker.scene.meshes.back().texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    maker.sphere({-1, 1, 0.5f}, 0.25f, black, textured(lamp_texture(maker, 4)));
    Texture of_mesh;
    of_mesh.kind = Texture::Kind::mesh_attribute;
    of_mesh.attribute = "vertex_glow";
    of_mesh.highest = 1e30f;
    maker.scene.textures.push_back(of_mesh);
    maker.parallelogram({2, -1, -1}, {0, 0, 1}, {0, 1, 0}, black,
                        textured(std::int32_t(maker.scene.textures.size()) - 1));
    maker.scene.meshes.back().attributes = {{"vertex_glow", 1, {0.5f, 1, 2, 4}}};
    maker.point_light({2, 1, 4}, {0, 1, -1});
    maker.directional_light({1, 2, 3}, {0.6f, -0.8f, 0});
    maker.spot({5, 6, 7}, {0.5f, 1.5f, 0}, {0, -1, 0}, 20, 50);
    add_picture(maker, Emitter::Kind::spot, lamp_texture(maker, 5), {0.25f, 1.25f, 0.125f});
    add_picture(maker, Emitter::Kind::projector, lamp_texture(maker, 6, true), {0.125f, 1.5f, 0.25f});
    maker.environment_map(16, 9, [](std::uint32_t x, std::uint32_t y) { return 1 + (5 * x + 3 * y) % 7 / 6.0; });
    return Emitters(maker.scene);
}

} // namespace
} // namespace gradus::testing

#define LIGHTS_OF EmittersOfAllKinds
#include "tests/scene/emitter_samples.inc"
