// Light samples chosen by a tree, the environment apart.
#define TRAIT_LIGHT_TEXTURES 0
#define TRAIT_TEXTURED_LIGHTS 0
#define TRAIT_TRIANGLES 1
#define TRAIT_SPHERES 1
#define TRAIT_LIGHT_TRIANGLE 1
#define TRAIT_LIGHT_SPHERE 1
#define TRAIT_LIGHT_POINT 1
#define TRAIT_LIGHT_CONSTANT 1
#define TRAIT_LIGHT_TREE 1 // the number of levels is an argument on the host
#include "tests/scene/emitter_case.h"

namespace gradus::testing {
namespace {

Emitters make_case() {
    SceneMaker maker(8, 1);
    add_lamps(maker);
    maker.point_light({2, 1, 4}, {0, 1, -1});
    for (int i = 0; i < 12; ++i)
        maker.lamp({float(i % 4) - 1.5f, 3, float(i / 4) - 1}, 0.3f, 0.2f, float(1 + i), 0);
    maker.environment(0.5);
    return Emitters(maker.scene, {1, 1});
}

} // namespace
} // namespace gradus::testing

#define LIGHTS_OF EmittersOfATree
#include "tests/scene/emitter_samples.inc"
