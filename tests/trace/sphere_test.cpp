// Rays and segments meet the nearest sphere that is there in double precision: from outside, from inside, whatever the
// length of their direction, and however many spheres there are (few are traced by packets of our own, many by Embree).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

#include "runtime/trace/tracer.h"

// After all others: its short macro names are not for library headers.
#include "kernels/shared/tables.h"

namespace gradus::testing {
namespace {

using Place = std::array<double, 3>;

double dot(const Place &a, const Place &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

struct Nearest {
    double parameter = std::numeric_limits<double>::infinity();
    std::uint32_t sphere = 0;
    bool is_clear = true; ///< nothing is so close to a choice that rounding may decide it
};

/// The nearest point of any sphere on origin + t direction, 0 < t < end.
Nearest nearest(const Scene &scene, const Place &origin, const Place &direction, double end) {
    constexpr double margin = 1e-4;
    Nearest found;
    const double a = dot(direction, direction);
    for (std::size_t i = 0; i < scene.spheres.size(); ++i) {
        const Sphere &sphere = scene.spheres[i];
        const double r = sphere.radius;
        const Place f{origin[0] - sphere.center.x, origin[1] - sphere.center.y, origin[2] - sphere.center.z};
        const double b = dot(f, direction), discriminant = b * b - a * (dot(f, f) - r * r);
        found.is_clear &= std::abs(discriminant) > margin * a * r * r;
        if (discriminant < 0)
            continue;
        for (const double t : {(-b - std::sqrt(discriminant)) / a, (-b + std::sqrt(discriminant)) / a}) {
            const double away = t * std::sqrt(a);
            found.is_clear &= std::abs(away) > margin && (std::isinf(end) || std::abs(t - end) > margin);
            found.is_clear &= std::abs(t - found.parameter) * std::sqrt(a) > margin || found.sphere == i;
            if (t > 0 && t < end && t < found.parameter) {
                found.parameter = t;
                found.sphere = std::uint32_t(i);
            }
        }
    }
    return found;
}

class SpheresInScenesOf : public ::testing::TestWithParam<int> {};

TEST_P(SpheresInScenesOf, AreMetWhereTheyAre) {
    std::mt19937_64 bits(7);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(bits);
    };
    Scene scene;
    scene.materials.resize(1);
    const double size = 2 * std::cbrt(1.0 / GetParam());
    for (int i = 0; i < GetParam(); ++i) {
        scene.spheres.push_back({{float(uniform(-3, 3)), float(uniform(-3, 3)), float(uniform(-3, 3))},
                                 float(size * uniform(0.3, 1)),
                                 false});
        scene.shapes.emplace_back().kind = Shape::Kind::sphere;
        scene.shapes.back().geometry = std::uint32_t(i);
    }
    constexpr std::size_t count = 20001; // no multiple of a packet
    std::vector<float> origin[3], direction[3];
    for (std::size_t i = 0; i < count; ++i) {
        const double length = std::pow(10, uniform(-1, 1));
        for (int axis = 0; axis < 3; ++axis) {
            origin[axis].push_back(float(uniform(-4, 4)));
            direction[axis].push_back(float(length * uniform(-1, 1)));
        }
    }
    std::vector<std::uint32_t> primitive(count, ray_pending), open(count, 1);
    RayColumns rays{};
    ShadowColumns segments{};
    for (int axis = 0; axis < 3; ++axis) {
        rays.origin[axis] = segments.origin[axis] = origin[axis].data();
        rays.direction[axis] = segments.direction[axis] = direction[axis].data();
    }
    rays.primitive = primitive.data();
    segments.open = open.data();
    Tracer(scene, 1).trace(rays, count, segments, count);
    std::size_t clear = 0, met = 0, shut = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Place from{origin[0][i], origin[1][i], origin[2][i]};
        const Place way{direction[0][i], direction[1][i], direction[2][i]};
        const Nearest ray = nearest(scene, from, way, std::numeric_limits<double>::infinity());
        if (ray.is_clear) {
            ++clear;
            met += std::isfinite(ray.parameter);
            ASSERT_EQ(primitive[i], std::isfinite(ray.parameter) ? ray.sphere : ray_escaped) << "ray " << i;
        }
        const Nearest segment = nearest(scene, from, way, 1);
        if (segment.is_clear) {
            shut += std::isfinite(segment.parameter);
            ASSERT_EQ(open[i], std::isfinite(segment.parameter) ? 0u : 1u) << "segment " << i;
        }
    }
    EXPECT_GT(clear, count * 9 / 10);
    EXPECT_GT(met, count / 20);
    EXPECT_GT(shut, count / 50);
}

INSTANTIATE_TEST_SUITE_P(Trace, SpheresInScenesOf, ::testing::Values(1, 12, 256, 300),
                         [](const auto &tested) { return std::to_string(tested.param) + "Spheres"; });

} // namespace
} // namespace gradus::testing
