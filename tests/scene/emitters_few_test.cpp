// Light samples where a scene has so few lights that all of them are loaded at once.
#define TRAIT_LIGHT_TEXTURES 0
#define TRAIT_TEXTURED_LIGHTS 0
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_LIGHT_TRIANGLE 1
#define TRAIT_LIGHT_SPHERE 1
#define TRAIT_LIGHT_CONSTANT 1
#define FEW_LIGHTS 4
#include "tests/scene/emitter_case.h"

namespace gradus::testing {
namespace {

Emitters make_case() {
    SceneMaker maker(8, 1);
    const std::uint32_t black = maker.material(diffuse(0));
    maker.parallelogram({-1, 2, -0.5f}, {1.5f, 0.2f, 0}, {0.1f, 0, 1}, black,
                        maker.emitter(Emitter::Kind::area, {3, 2, 1}));
    maker.sphere({1.5f, 0.5f, 0.25f}, 0.4f, black, maker.emitter(Emitter::Kind::area, {1, 5, 2}));
    maker.environment(0.5);
    return Emitters(maker.scene);
}

} // namespace
} // namespace gradus::testing

#define LIGHTS_OF EmittersThatAreFew
#include "tests/scene/emitter_samples.inc"
