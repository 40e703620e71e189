// Places in surfaces, and those beside them.
#include "runtime/scene/lights_in_surfaces.h"

#include "runtime/scene/instances.h"
#include "tests/support/small_scenes.h"

#include <gtest/gtest.h>

namespace gradus::testing {
namespace {

/// Of lights at these places.
std::vector<float> gaps_of(SceneMaker maker, const std::vector<Vector3> &places) {
    for (const Vector3 &place : places)
        maker.point_light({1, 1, 1}, place);
    return gaps_in_surfaces(maker.scene);
}

TEST(GapsInSurfaces, AreWiderThanTheTracerErrsAndNoWiderThanTheyMustBe) {
    SceneMaker maker(4, 1);
    const std::uint32_t material = maker.material(diffuse(0.5));
    maker.parallelogram({-1, 2, -1}, {2, 0, 0}, {0, 0, 2}, material);
    maker.parallelogram({-100, 0, -100}, {200, 0, 0}, {0, 0, 200}, material);
    maker.sphere({0, 5, 0}, 1, material);
    // In the plate, the floor, both ends of the sphere; in nothing: beside the plate, over it, in the sphere's middle.
    const std::vector<float> gaps =
        gaps_of(maker, {{0.25f, 2, 0.5f}, {3, 0, 4}, {0, 6, 0}, {-1, 5, 0}, {1.01f, 2, 0}, {0, 2.0001f, 0}, {0, 5, 0}});
    ASSERT_EQ(gaps.size(), 7u);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_GT(gaps[i], 1e-5) << i;
    EXPECT_LT(gaps[0], 1e-4);
    EXPECT_GT(gaps[1], 50 * gaps[0]);
    EXPECT_LT(gaps[2], 3e-4);
    for (std::size_t i = 4; i < 7; ++i)
        EXPECT_EQ(gaps[i], 0) << i;
}

TEST(GapsInSurfaces, AreOfTheWidestThatMeetThere) {
    SceneMaker maker(4, 1);
    const std::uint32_t material = maker.material(diffuse(0.5));
    maker.parallelogram({-100, 0, -100}, {200, 0, 0}, {0, 0, 200}, material);
    const std::vector<Vector3> place = {{3, 0, 4}};
    const float of_floor = gaps_of(maker, place)[0];
    maker.parallelogram({2, 0, 3}, {2, 0, 0}, {0, 0, 2}, material);
    EXPECT_EQ(gaps_of(maker, place)[0], of_floor);
}

TEST(GapsInSurfaces, KnowInstances) {
    SceneMaker maker(4, 1);
    maker.parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, maker.material(diffuse(0.5)));
    maker.scene.shapes.back().group = 0;
    maker.scene.groups = 1;
    const std::vector<Vector3> places = {{0.25f, 0, 0.5f}, {5.25f, 3, 0.5f}};
    EXPECT_EQ(gaps_of(maker, places), std::vector<float>(2)) << "a group that is nowhere";
    maker.scene.instances.push_back(make_instance(0, translation({5, 3, 0})));
    const std::vector<float> gaps = gaps_of(maker, places);
    EXPECT_EQ(gaps[0], 0);
    EXPECT_GT(gaps[1], 1e-5);
    // No thicker than rounding, and a little off.
    EXPECT_GT(gaps_of(maker, {{5.25f, 3.0000005f, 0.5f}})[0], 1e-5);
}

/// Whichever of many places lies in one of many.
TEST(GapsInSurfaces, KnowEachOfManyInstances) {
    SceneMaker maker(4, 1);
    maker.parallelogram({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, maker.material(diffuse(0.5)));
    maker.scene.shapes.back().group = 0;
    maker.scene.groups = 1;
    std::vector<Vector3> places;
    for (int i = 0; i < 1000; ++i) {
        const double x = 4 * (i * 7 % 1000); // in no order
        maker.scene.instances.push_back(make_instance(0, translation({x, 0, 0})));
        places.push_back({float(x + 0.75 * (i % 3 - 1)), i % 2 == 0 ? 0.0f : 1.0f, 0.5f});
    }
    const std::vector<float> gaps = gaps_of(maker, places);
    for (std::size_t i = 0; i < gaps.size(); ++i)
        EXPECT_EQ(gaps[i] > 0, i % 2 == 0) << i;
}

TEST(GapsInSurfaces, AreNothingOfNothing) {
    const SceneMaker maker(4, 1);
    EXPECT_TRUE(gaps_of(maker, {}).empty());
    EXPECT_EQ(gaps_of(maker, {{0, 0, 0}}), std::vector<float>(1));
}

} // namespace
} // namespace gradus::testing
