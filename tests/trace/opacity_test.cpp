// Surfaces that a share of the rays meets: which do is decided by the ray and the primitive alone, and primitives keep
// their numbers.
#include "runtime/trace/opacity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/trace/tracer.h"
#include "tests/support/small_scenes.h"

#include "kernels/shared/tables.h"

namespace gradus::testing {
namespace {

constexpr std::size_t rays = 20000;

/// Rays from z = -5 to z = 5 through the square [-0.9, 0.9]^2, aslant.
struct Rays {
    Rays() {
        std::mt19937 bits(3);
        std::uniform_real_distribution<float> place(-0.9f, 0.9f);
        for (std::size_t i = 0; i < rays; ++i) {
            const float x = place(bits), y = place(bits);
            const float values[] = {x, y, -5, place(bits) - x, place(bits) - y, 10};
            for (int axis = 0; axis < 3; ++axis) {
                origin[axis].push_back(values[axis]);
                direction[axis].push_back(values[3 + axis]);
            }
        }
    }
    /// The primitives that they meet, or whether the way is open, for the rays from `first` on.
    std::vector<std::uint32_t> trace(Tracer &tracer, bool shadows, std::size_t first = 0, std::size_t count = rays) {
        std::vector<std::uint32_t> state(count, shadows ? 1 : ray_pending);
        SegmentColumns columns{};
        for (int axis = 0; axis < 3; ++axis) {
            columns.origin[axis] = origin[axis].data() + first;
            columns.direction[axis] = direction[axis].data() + first;
        }
        if (shadows)
            tracer.trace({}, 0, {columns, state.data()}, count);
        else
            tracer.trace({columns, state.data()}, count, {}, 0);
        return state;
    }
    std::vector<float> origin[3], direction[3];
};

Material with_opacity(float opacity) {
    Material material = material_of(diffuse(0.5));
    material.opacity = opacity;
    return material;
}

/// The square [-1, 1]^2 at z.
void add_screen(SceneMaker &maker, float z, float opacity) {
    maker.parallelogram({-1, -1, z}, {2, 0, 0}, {0, 2, 0}, maker.material(with_opacity(opacity)));
}

double share(const std::vector<std::uint32_t> &states, std::uint32_t first, std::uint32_t last) {
    return double(std::count_if(states.begin(), states.end(),
                                [&](std::uint32_t state) { return state >= first && state <= last; })) /
           double(states.size());
}

/// Five standard deviations of a share of so many.
double allowed(double share) { return 5 * std::sqrt(share * (1 - share) / rays); }

TEST(Opacity, IsTheShareOfRaysThatMeetASurface) {
    SceneMaker maker(8, 1);
    add_screen(maker, 2, 1);
    add_screen(maker, 0, 0.3f);
    maker.sphere({0, 0, 1}, 3, maker.material(with_opacity(0.6f))); // met from outside, in front of both
    add_screen(maker, -1, 0.8f);                                    // inside the sphere, before the others
    maker.sphere({20, 0, 0}, 1, maker.material(diffuse(0.5)));
    Tracer tracer(maker.scene, 2);
    Rays all;
    // In the scene's order: two triangles a screen, then the spheres.
    const std::vector<std::uint32_t> met = all.trace(tracer, false);
    EXPECT_NEAR(share(met, 6, 6), 0.6, allowed(0.6)) << "the sphere";
    EXPECT_NEAR(share(met, 4, 5), 0.4 * 0.8, allowed(0.32));
    EXPECT_NEAR(share(met, 2, 3), 0.4 * 0.2 * 0.3, allowed(0.024));
    EXPECT_NEAR(share(met, 0, 1), 0.4 * 0.2 * 0.7, allowed(0.056)) << "the opaque one behind them";
    EXPECT_EQ(share(met, ray_escaped, ray_escaped), 0);
    EXPECT_EQ(share(all.trace(tracer, true), 1, 1), 0);
    maker.scene.shapes.erase(maker.scene.shapes.begin());
    Tracer open(maker.scene, 2);
    // The sphere is passed twice where it is passed at all, and a ray passes both sides or neither.
    EXPECT_NEAR(share(all.trace(open, true), 1, 1), 0.4 * 0.2 * 0.7, allowed(0.056));
}

TEST(Opacity, DependsOnTheRayAlone) {
    SceneMaker maker(8, 1);
    for (int i = 0; i < 4; ++i)
        add_screen(maker, float(i), 0.4f);
    maker.sphere({0, 0, -2}, 1, maker.material(with_opacity(0.5f)));
    Tracer tracer(maker.scene, 2), single(maker.scene, 1);
    single.set_order(RayOrder::none, RayOrder::none);
    Rays all;
    for (const bool shadows : {false, true}) {
        const std::vector<std::uint32_t> together = all.trace(tracer, shadows);
        for (const std::size_t part : {std::size_t(1), std::size_t(17), std::size_t(3000)})
            for (std::size_t first = 0; first + part <= rays; first += rays / 7) {
                const std::vector<std::uint32_t> apart = all.trace(single, shadows, first, part);
                for (std::size_t i = 0; i < part; ++i)
                    ASSERT_EQ(apart[i], together[first + i]) << "ray " << first + i << " of " << part;
            }
    }
}

// A checkerboard of 0 and 1 on a square with (u, v) from 0 to 1.
TEST(Opacity, IsReadWhereTheRayMeetsTheSurface) {
    SceneMaker maker(8, 1);
    Texture board;
    board.kind = Texture::Kind::checkerboard;
    board.color_0 = {0, 0, 0};
    board.color_1 = {1, 1, 1};
    maker.scene.textures.push_back(board);
    Material material = with_opacity(1);
    material.opacity.texture = 0;
    maker.parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material));
    Tracer tracer(maker.scene, 2);
    Rays all;
    const std::vector<std::uint32_t> met = all.trace(tracer, false), open = all.trace(tracer, true);
    std::size_t passed = 0;
    for (std::size_t i = 0; i < rays; ++i) {
        const double u = (all.origin[0][i] + 0.5 * all.direction[0][i] + 1) / 2,
                     v = (all.origin[1][i] + 0.5 * all.direction[1][i] + 1) / 2;
        if (std::min({std::fabs(u - 0.5), std::fabs(v - 0.5)}) < 1e-6)
            continue; // rounding may tell on which field it is
        const bool is_there = texture_value(board, u, v)[0] > 0.5;
        ASSERT_EQ(met[i] != ray_escaped, is_there) << u << " " << v;
        ASSERT_EQ(open[i], is_there ? 0u : 1u);
        passed += is_there ? 0 : 1;
    }
    EXPECT_NEAR(double(passed) / rays, 0.5, 0.1);
}

TEST(Opacity, OfALampIsOne) {
    SceneMaker maker(8, 1);
    maker.parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(with_opacity(0.1f)),
                        maker.emitter(Emitter::Kind::area, {1, 1, 1}));
    Tracer tracer(maker.scene, 1);
    Rays all;
    EXPECT_EQ(share(all.trace(tracer, false), 0, 1), 1);
}

} // namespace
} // namespace gradus::testing
