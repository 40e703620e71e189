// The picture of a surface depends on that surface, not on what else the scene has.
#include "tests/support/render.h"
#include "tests/support/small_scenes.h"

namespace gradus::testing {
namespace {

/// A ball of few facets with smooth normals, which at its rim are often seen from the other side than the facet, under
/// a point light; light that bounced is left out, so that no card can shade it or light it.
SceneMaker lit_ball(const Material &material) {
    SceneMaker maker(64, 4);
    maker.look({0, 0.5, -4}, {0, 0, 0}, 32);
    maker.scene.settings.max_depth = 2;
    maker.point_light({20, 20, 20}, {2, 3, -3});
    maker.scene.meshes.push_back(coarse_ball({0, 0, 0}, 1, true, 5, 8));
    maker.shape(Shape::Kind::mesh, maker.scene.meshes.size() - 1, maker.material(material), -1);
    return maker;
}

/// A card whose sides differ, behind the camera and out of the light's way.
void add_card(SceneMaker &maker, const Material &material) {
    maker.parallelogram({-1, -6, -9}, {2, 0, 0}, {0, 2, 0}, maker.material(material));
}

void expect_same(const Image &image, const Image &other) {
    for (const char *channel : {"R", "G", "B"})
        EXPECT_EQ(image.find(channel)->values, other.find(channel)->values) << channel;
}

TEST(TwoSided, ACardElsewhereChangesNothing) {
    for (const char *method : {"pt", "gpt"}) {
        SCOPED_TRACE(method);
        const Material paint = two_sided(diffuse(0.7));
        SceneMaker with = lit_ball(paint);
        add_card(with, two_sided(diffuse(0.2), mirror()));
        expect_same(render(with.scene, {}, method).image, render(lit_ball(paint).scene, {}, method).image);
    }
}

// What a ray is sorted by and what it is shaded as are one side.
TEST(TwoSided, TheBackIsWhereTheShadingNormalFacesAway) {
    Bsdf black_metal = rough_metal(0.3);
    black_metal.specular_reflectance = {0, 0, 0};
    const Image same_kind = render(lit_ball(two_sided(diffuse(0.7), diffuse(0))).scene).image;
    const Image other_kind = render(lit_ball(two_sided(diffuse(0.7), black_metal)).scene).image;
    expect_same(same_kind, other_kind);
    const Image both_sides = render(lit_ball(two_sided(diffuse(0.7))).scene).image;
    const std::vector<float> &some = same_kind.find("R")->values, &all = both_sides.find("R")->values;
    int backs = 0;
    for (std::size_t i = 0; i < some.size(); ++i)
        backs += some[i] != all[i];
    EXPECT_GT(backs, 10) << "pixels that see backs";
}

} // namespace
} // namespace gradus::testing
